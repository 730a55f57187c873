//! A mesh that is skinned on the GPU.

use std::sync::Arc;

use glam::{Vec3, Vec4};
use tressfx_core::backend::{Backend, ComputeDesc, Owner};
use tressfx_core::body::{MeshPose, SkinnedMesh};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Bindings, Kernel, Shader, Specialization};

use super::palette::{JointPalette, packed};
use super::triangle_roots::MeshVertices;
use crate::buffers::storage;
use crate::error::SimError;
use crate::kernel::{GROUP, skin};

gpu_struct! {
    /// A vertex of the bind pose, as the kernel reads it.
    pub struct BoundVertex {
        /// Where it is.
        pub position: Vec3,
        /// Its first two joints, the first in the lower half.
        pub joints_01: u32,
        /// A unit vector.
        pub normal: Vec3,
        /// Its other joints.
        pub joints_23: u32,
        /// The share of each joint.
        pub weights: Vec4,
    }
}

gpu_struct! {
    /// What a morph target moves a vertex by.
    struct MorphOffset {
        /// Added to its position; the fourth holds the bits of the number of the target.
        pub position: Vec4,
        /// Added to its normal.
        pub normal: Vec4,
    }
}

/// A [`SkinnedMesh`] on the GPU, and the kernel that moves it. It takes 80 bytes a vertex, 32 an offset of a morph target and 48 a joint; 32 a vertex more where
/// the frame before is kept, and 32 where the mesh has tangents: clear [`SkinnedMesh::tangents`] if nobody asks for them.
#[derive(Debug)]
pub struct Skinning {
    /// Positions and normals for the checks of poses, without the arrays.
    mesh: SkinnedMesh,
    palette: JointPalette,
    morph_weights: Option<BufferId>,
    vertices: BufferId,
    past: Option<BufferId>,
    tangents: Option<BufferId>,
    vertex_count: u32,
    has_pose: bool,
    kernel: Kernel,
    bindings: Bindings,
    owner: Owner,
}

impl Skinning {
    /// Makes what it needs, and uploads the mesh with `list`. `keeps_past` says whether [`Skinning::past_vertices`] is asked for: where it is not, it costs nothing.
    ///
    /// # Errors
    /// A mesh whose arrays do not fit each other, or what the backend says.
    pub fn new(
        backend: &mut dyn Backend,
        list: &mut PassList,
        mesh: &SkinnedMesh,
        keeps_past: bool,
    ) -> Result<Self, SimError> {
        mesh.check()?;
        let vertex_count = mesh.positions.len() as u32;
        let offsets = MorphOffsets::new(mesh);
        let mut uploads = PassList::new();
        let (made, owner) = Owner::build(backend, |backend| {
            let palette = JointPalette::new(backend, &mut uploads, mesh.joints.len())?;
            let bound = storage(backend, "hair.body.bound", 48, vertex_count)?;
            let vertices = storage(backend, "hair.body.vertices", 32, vertex_count)?;
            let past = if keeps_past { Some(storage(backend, "hair.body.past", 32, vertex_count)?) } else { None };
            uploads.upload(bound, 0, &bound_vertices(mesh));
            let mut resources = vec![
                ("bound_vertices", bound.into()),
                ("joints", palette.buffer.into()),
                ("vertices", vertices.into()),
            ];
            let mut morph_weights = None;
            if let Some(MorphOffsets { first, offsets }) = &offsets {
                let firsts = storage(backend, "hair.body.first_offsets", 4, first.len() as u32)?;
                let entries = storage(backend, "hair.body.morph_offsets", 32, offsets.len() as u32)?;
                let weights = storage(backend, "hair.body.morph_weights", 4, mesh.morphs.len() as u32)?;
                uploads.upload(firsts, 0, first);
                uploads.upload(entries, 0, offsets);
                resources.extend([
                    ("first_offsets", firsts.into()),
                    ("morph_offsets", entries.into()),
                    ("morph_weights", weights.into()),
                ]);
                morph_weights = Some(weights);
            }
            let tangents = match &mesh.tangents[..] {
                [] => None,
                of_mesh => {
                    let bound = storage(backend, "hair.body.bound_tangents", 16, vertex_count)?;
                    let tangents = storage(backend, "hair.body.tangents", 16, vertex_count)?;
                    uploads.upload(bound, 0, of_mesh);
                    resources.extend([("bound_tangents", bound.into()), ("tangents", tangents.into())]);
                    Some(tangents)
                }
            };
            let specialization = Specialization::new();
            let specialization = specialization.feature("morphs", offsets.is_some());
            let specialization = specialization.feature("tangents", tangents.is_some());
            let shader = Arc::new(Shader::new(&skin::SOURCE, &specialization)?);
            let kernel = backend.create_compute(&ComputeDesc::new(shader))?;
            let bindings = kernel.bind(&resources)?;
            Ok::<_, SimError>((palette, morph_weights, (vertices, past, tangents), kernel, bindings))
        })?;
        list.append(&uploads);
        let (palette, morph_weights, (vertices, past, tangents), kernel, bindings) = made;
        let mesh = SkinnedMesh {
            name: mesh.name.clone(),
            joints: mesh.joints.clone(),
            morphs: mesh
                .morphs
                .iter()
                .map(|morph| tressfx_core::body::Morph { offsets: Vec::new(), ..morph.clone() })
                .collect(),
            ..SkinnedMesh::default()
        };
        let has_pose = false;
        Ok(Self {
            mesh,
            palette,
            morph_weights,
            vertices,
            past,
            tangents,
            vertex_count,
            has_pose,
            kernel,
            bindings,
            owner,
        })
    }

    /// Moves the mesh: one pass. What it was before is kept where that was asked for; the first pose is its own past.
    ///
    /// # Errors
    /// A pose of another mesh, or one that is not finite; nothing is recorded then.
    pub fn pose(&mut self, list: &mut PassList, pose: &MeshPose) -> Result<(), SimError> {
        self.mesh.check_pose(pose)?;
        let bytes = 32 * u64::from(self.vertex_count);
        let past = self.past.filter(|_| self.has_pose);
        past.into_iter().for_each(|past| list.copy(self.vertices, past, bytes));
        self.palette.set(list, &pose.joints)?;
        self.morph_weights.into_iter().for_each(|weights| list.upload(weights, 0, &pose.morphs));
        list.compute(&self.kernel, &self.bindings, Grid::for_threads(self.vertex_count, GROUP));
        if let Some(past) = self.past.filter(|_| !self.has_pose) {
            list.copy(self.vertices, past, bytes);
        }
        self.has_pose = true;
        Ok(())
    }

    /// Two `vec4<f32>` a vertex: its position and 1, its unit normal and 0, in the space of the mesh. Rasters, fields and roots may read it.
    pub fn vertices(&self) -> BufferId {
        self.vertices
    }

    /// The same before the last [`Skinning::pose`], for motion vectors; `None` where it is not kept.
    pub fn past_vertices(&self) -> Option<BufferId> {
        self.past
    }

    /// A `vec4<f32>` a vertex: its unit tangent, across the normal, and the side of the bitangent; `None` where the mesh has none. Morph targets move them only by their normals.
    pub fn tangents(&self) -> Option<BufferId> {
        self.tangents
    }

    /// What [`TriangleRoots`](super::TriangleRoots) reads.
    pub fn mesh_vertices(&self) -> MeshVertices {
        MeshVertices { buffer: self.vertices, stride: 32, offset: 0, count: self.vertex_count }
    }

    /// The matrices of its joints, for [`BoneRoots`](super::BoneRoots).
    pub fn palette(&self) -> JointPalette {
        self.palette
    }

    /// Frees everything.
    pub fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }
}

fn bound_vertices(mesh: &SkinnedMesh) -> Vec<BoundVertex> {
    let vertices = mesh.positions.iter().zip(&mesh.normals).zip(&mesh.influences);
    let vertex = |((&position, &normal), of): ((&Vec3, &Vec3), &tressfx_core::body::Influences)| {
        let [joints_01, joints_23] = packed(of.joints);
        BoundVertex { position, joints_01, normal, joints_23, weights: of.weights.into() }
    };
    vertices.map(vertex).collect()
}

/// The offsets of all morph targets, vertex after vertex.
struct MorphOffsets {
    /// Of each vertex the first, and behind the last vertex how many there are.
    first: Vec<u32>,
    offsets: Vec<MorphOffset>,
}

impl MorphOffsets {
    /// `None` where nothing is moved.
    fn new(mesh: &SkinnedMesh) -> Option<Self> {
        let all = mesh.morphs.iter().enumerate();
        let mut all: Vec<_> =
            all.flat_map(|(target, morph)| morph.offsets.iter().map(move |offset| (target, offset))).collect();
        all.sort_by_key(|(target, offset)| (offset.vertex, *target));
        let mut first = vec![0; mesh.positions.len() + 1];
        all.iter().for_each(|(_, offset)| first[offset.vertex as usize + 1] += 1);
        for vertex in 1..first.len() {
            first[vertex] += first[vertex - 1];
        }
        let entry = |&(target, offset): &(usize, &tressfx_core::body::MorphOffset)| MorphOffset {
            position: offset.position.extend(f32::from_bits(target as u32)),
            normal: offset.normal.extend(0.0),
        };
        let offsets: Vec<_> = all.iter().map(entry).collect();
        (!offsets.is_empty()).then_some(Self { first, offsets })
    }
}
