//! A kernel that writes where the roots of a section are.

use std::sync::Arc;

use glam::Vec3;
use tressfx_core::backend::{Backend, BufferDesc, ComputeDesc, Owner};
use tressfx_core::gpu_struct;
use tressfx_core::id::BufferId;
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Binding, Bindings, Kernel, Shader, ShaderSource, Specialization};

use crate::HairSim;
use crate::buffers::storage;
use crate::error::SimError;
use crate::kernel::GROUP;

gpu_struct! {
    /// What all roots of a section share.
    pub struct RootSource {
        /// The centre of the groom, in the space of the mesh.
        pub center: Vec3,
        /// Guides of the section.
        pub guides: u32,
        /// Numbers from vertex to vertex.
        pub stride: u32,
        /// Numbers before the first position.
        pub first: u32,
        /// Nothing.
        pub padding: [u32; 2],
    }
}

/// The kernel with its buffers.
#[derive(Debug)]
pub(super) struct RootsPass {
    kernel: Kernel,
    bindings: Bindings,
    guides: u32,
    owner: Owner,
}

/// Where the roots of a section are written, if there are as many as `given`.
pub(super) fn targets(sim: &HairSim, section: usize, given: usize) -> Result<BufferId, SimError> {
    let Some(buffers) = sim.buffers().get(section) else {
        return Err(SimError::NoSection { index: section, count: sim.buffers().len() });
    };
    let targets = sim.root_transforms(section);
    let expected = targets.map_or(0, |_| buffers.shape.guides as usize);
    targets.filter(|_| given == expected).ok_or(SimError::RootCount { given, expected })
}

impl RootsPass {
    /// `roots` has an entry a guide of the section.
    pub(super) fn new<T: bytemuck::NoUninit>(
        backend: &mut dyn Backend,
        list: &mut PassList,
        kernel: &ShaderSource,
        source: RootSource,
        (roots, targets): (&[T], BufferId),
        read: (&'static str, Binding),
    ) -> Result<Self, SimError> {
        let ((kernel, bindings, uniform, bound), owner) = Owner::build(backend, |backend| {
            let uniform =
                backend.create_buffer(&BufferDesc::uniform("hair.root_source", size_of::<RootSource>() as u64))?;
            let bound = storage(backend, "hair.bound_roots", size_of::<T>() as u64, roots.len() as u32)?;
            let shader = Arc::new(Shader::new(kernel, &Specialization::new())?);
            let kernel = backend.create_compute(&ComputeDesc::new(shader))?;
            let resources =
                [("source", uniform.into()), ("bound_roots", bound.into()), ("targets", targets.into()), read];
            let bindings = kernel.bind(&resources)?;
            Ok::<_, tressfx_core::Error>((kernel, bindings, uniform, bound))
        })?;
        list.upload(uniform, 0, &[source]);
        list.upload(bound, 0, roots);
        Ok(Self { kernel, bindings, guides: source.guides, owner })
    }

    pub(super) fn record(&self, list: &mut PassList, sim: &mut HairSim) {
        list.compute(&self.kernel, &self.bindings, Grid::for_threads(self.guides, GROUP));
        sim.wake();
    }

    pub(super) fn destroy(self, backend: &mut dyn Backend) {
        self.owner.destroy(backend);
    }
}
