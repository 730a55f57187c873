//! Roots that ride on the triangles of a mesh.

use glam::{UVec3, Vec3, Vec4};
use tressfx_core::backend::Backend;
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;

use super::bind::{Binding, BoundRoot};
use super::roots_pass::{RootSource, RootsPass, targets};
use crate::HairSim;
use crate::error::SimError;
use crate::kernel::triangle_roots;

gpu_struct! {
    /// A root on a triangle, as the kernel reads it.
    pub struct TriangleRoot {
        /// The vertices of the triangle.
        pub corners: UVec3,
        /// Where the root is along the edge from the first corner to the second.
        pub u: f32,
        /// From the triangle to the root, in the frame.
        pub offset: Vec3,
        /// Where the root is along the edge from the first corner to the third.
        pub v: f32,
        /// The tangent and the bitangent, each as a sum of these two edges.
        pub edges: Vec4,
        /// The frame in the bind pose: a unit quaternion that takes x to the tangent and z to the normal.
        pub frame: Vec4,
        /// Where the root is in the bind pose, relative to the centre.
        pub rest: Vec3,
        /// Nothing.
        pub padding: f32,
    }
}

impl TriangleRoot {
    /// As the kernel reads it, with the centre of the groom.
    pub fn new(root: &BoundRoot, center: Vec3) -> Self {
        let [tangent, bitangent] = root.edges;
        Self {
            corners: UVec3::from(root.corners),
            u: root.place.x as f32,
            offset: root.offset.as_vec3(),
            v: root.place.y as f32,
            edges: Vec4::new(tangent.x as f32, tangent.y as f32, bitangent.x as f32, bitangent.y as f32),
            frame: root.frame.as_quat().into(),
            rest: (root.root - center.as_dvec3()).as_vec3(),
            padding: 0.0,
        }
    }
}

/// Where the positions of a mesh are: those of a [`Skinning`](super::Skinning), or an engine's own that it has imported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshVertices {
    /// A storage buffer; positions are three `f32` each, in the space of the head.
    pub buffer: BufferId,
    /// Bytes from vertex to vertex, a multiple of 4.
    pub stride: u32,
    /// Bytes before the first position, a multiple of 4.
    pub offset: u32,
    /// How many vertices there are; they are those of the mesh that roots were bound to, in its order.
    pub count: u32,
}

/// The roots of a section on a mesh that moves: one pass a frame.
#[derive(Debug)]
pub struct TriangleRoots(RootsPass);

impl TriangleRoots {
    /// Makes what it needs, and uploads the roots with `list`. The binding is that of the section's guides, in their order.
    ///
    /// # Errors
    /// A section without roots of its own or that does not exist, another number of roots than guides, a mesh with fewer vertices than they are bound
    /// to, a stride or an offset that is no multiple of 4 or too small, or what the backend says.
    pub fn new(
        backend: &mut dyn Backend,
        list: &mut PassList,
        sim: &HairSim,
        section: usize,
        binding: &Binding,
        mesh: MeshVertices,
    ) -> Result<Self, SimError> {
        let targets = targets(sim, section, binding.roots.len())?;
        let last = binding.roots.iter().flat_map(|root| root.corners).max().unwrap_or(0);
        let is_laid_out = mesh.stride.is_multiple_of(4) && mesh.offset.is_multiple_of(4) && mesh.stride >= 12;
        if last >= mesh.count || !is_laid_out {
            return Err(SimError::MeshVertices { last, mesh });
        }
        let center = sim.center();
        let source = RootSource {
            center,
            guides: binding.roots.len() as u32,
            stride: mesh.stride / 4,
            first: mesh.offset / 4,
            padding: [0; 2],
        };
        let roots: Vec<_> = binding.roots.iter().map(|root| TriangleRoot::new(root, center)).collect();
        let read = ("mesh", mesh.buffer.into());
        RootsPass::new(backend, list, &triangle_roots::SOURCE, source, (&roots, targets), read).map(Self)
    }

    /// Says where the roots are at the end of the next frame, from where the mesh is now. It comes behind what skins the mesh and before
    /// [`HairSim::step`].
    pub fn record(&self, list: &mut PassList, sim: &mut HairSim) {
        self.0.record(list, sim);
    }

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.0.destroy(backend);
    }
}
