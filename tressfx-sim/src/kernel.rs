//! The kernels: one file of WGSL in `shaders/`, one function here and one in [`crate::reference`], all of the same name.
//!
//! What the kernels of both solvers ask for, and the stages of `tressfx`, are in modules without an entry point.

pub(crate) mod bone_roots;
pub(crate) mod direct;
pub(crate) mod direct_near;
pub(crate) mod field_bounds;
pub(crate) mod field_crossings;
pub(crate) mod field_flood;
pub(crate) mod field_grid;
pub(crate) mod field_seed;
pub(crate) mod field_sign;
pub(crate) mod field_splat;
pub(crate) mod interpolate;
pub(crate) mod moved;
pub(crate) mod roots;
pub(crate) mod skin;
pub(crate) mod surface_count;
pub(crate) mod surface_emit;
pub(crate) mod surface_scan;
pub(crate) mod tangents;
pub(crate) mod tressfx;
pub(crate) mod triangle_roots;
pub(crate) mod volume_nodes;
pub(crate) mod volume_push;
pub(crate) mod volume_splat;

use std::sync::Arc;

use tressfx_core::Result;
use tressfx_core::backend::{Backend, ComputeDesc};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Binding, Bindings, Kernel, Module, Shader, ShaderSource, Specialization};

use crate::buffers::{STEPS, SectionBuffers};
use crate::section::Shared;
use crate::volume::Volume;

/// Threads of a group; `package::grid::GROUP` in WGSL.
pub(crate) const GROUP: u32 = 64;

/// The WGSL modules that the kernels share.
pub(crate) const LIBRARY: &[Module] = &[
    ("capsule", include_str!("../shaders/capsule.wgsl")),
    ("contact", include_str!("../shaders/contact.wgsl")),
    ("counts", include_str!("../shaders/counts.wgsl")),
    ("eliminate", include_str!("../shaders/eliminate.wgsl")),
    ("eliminate_together", include_str!("../shaders/eliminate_together.wgsl")),
    ("field", include_str!("../shaders/field.wgsl")),
    ("field_contact", include_str!("../shaders/field_contact.wgsl")),
    ("field_mesh", include_str!("../shaders/field_mesh.wgsl")),
    ("field_side", include_str!("../shaders/field_side.wgsl")),
    ("hand_over", include_str!("../shaders/hand_over.wgsl")),
    ("integrate", include_str!("../shaders/integrate.wgsl")),
    ("joint", include_str!("../shaders/joint.wgsl")),
    ("joint_matrix", include_str!("../shaders/joint_matrix.wgsl")),
    ("left", include_str!("../shaders/left.wgsl")),
    ("lengths", include_str!("../shaders/lengths.wgsl")),
    ("local_shape", include_str!("../shaders/local_shape.wgsl")),
    ("nodes", include_str!("../shaders/nodes.wgsl")),
    ("rod", include_str!("../shaders/rod.wgsl")),
    ("rod_contact", include_str!("../shaders/rod_contact.wgsl")),
    ("rod_near", include_str!("../shaders/rod_near.wgsl")),
    ("rod_touch", include_str!("../shaders/rod_touch.wgsl")),
    ("root", include_str!("../shaders/root.wgsl")),
    ("root_frame", include_str!("../shaders/root_frame.wgsl")),
    ("step", include_str!("../shaders/step.wgsl")),
    ("sub_step", include_str!("../shaders/sub_step.wgsl")),
    ("sub_step_together", include_str!("../shaders/sub_step_together.wgsl")),
    ("substitute", include_str!("../shaders/substitute.wgsl")),
    ("substitute_together", include_str!("../shaders/substitute_together.wgsl")),
    ("surface", include_str!("../shaders/surface.wgsl")),
    ("symmetric", include_str!("../shaders/symmetric.wgsl")),
    ("take_out", include_str!("../shaders/take_out.wgsl")),
    ("terms", include_str!("../shaders/terms.wgsl")),
    ("together", include_str!("../shaders/together.wgsl")),
    ("vector", include_str!("../shaders/vector.wgsl")),
    ("volume", include_str!("../shaders/volume.wgsl")),
    ("volume_vertex", include_str!("../shaders/volume_vertex.wgsl")),
    ("wind", include_str!("../shaders/wind.wgsl")),
];

/// A kernel with everything that it needs to run.
#[derive(Debug)]
pub(crate) struct Pass {
    kernel: Kernel,
    /// For each of the section's steps.
    bindings: Vec<Bindings>,
    grid: Grid,
}

impl Pass {
    /// Runs the kernel with one of the section's steps.
    pub(crate) fn record(&self, list: &mut PassList, step: usize) {
        list.compute(&self.kernel, &self.bindings[step], self.grid);
    }
}

/// The compiled kernels of a simulation. Sections with the same features share them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kernels(Vec<Kernel>);

impl Kernels {
    /// The kernel of a source with these features, compiled if it is the first time.
    fn get(
        &mut self,
        backend: &mut dyn Backend,
        source: &ShaderSource,
        specialization: &Specialization,
    ) -> Result<Kernel> {
        let known =
            |kernel: &&Kernel| kernel.shader.label == source.label && kernel.shader.specialization == *specialization;
        if let Some(kernel) = self.0.iter().find(known) {
            return Ok(kernel.clone());
        }
        let shader = Arc::new(Shader::new(source, specialization)?);
        let kernel = backend.create_compute(&ComputeDesc::new(shader))?;
        self.0.push(kernel.clone());
        Ok(kernel)
    }

    /// A pass of a kernel that is always bound the same.
    pub(crate) fn pass_of(
        &mut self,
        backend: &mut dyn Backend,
        source: &ShaderSource,
        specialization: &Specialization,
        resources: &[(&str, Binding)],
        grid: Grid,
    ) -> Result<Pass> {
        let kernel = self.get(backend, source, specialization)?;
        let bindings = vec![kernel.bind(resources)?];
        Ok(Pass { kernel, bindings, grid })
    }
}

/// What it takes to make the passes of a section.
pub(crate) struct PassMaker<'a> {
    pub(crate) backend: &'a mut dyn Backend,
    pub(crate) kernels: &'a mut Kernels,
    pub(crate) buffers: &'a SectionBuffers,
    pub(crate) shared: &'a Shared,
}

impl PassMaker<'_> {
    /// A pass of a kernel that is the same for all sections.
    fn pass(
        &mut self,
        source: &ShaderSource,
        specialization: &Specialization,
        resources: &[(&str, Binding)],
        grid: Grid,
    ) -> Result<Pass> {
        let kernel = self.kernels.get(self.backend, source, specialization)?;
        let steps = &self.buffers.steps;
        let with = |step| kernel.bind(&[&[("step", steps.binding(step))], resources].concat());
        let bindings = (0..STEPS).map(with).collect::<Result<_>>()?;
        Ok(Pass { kernel, bindings, grid })
    }

    /// A pass of a kernel that asks for the motion of its roots.
    fn pass_with_roots(
        &mut self,
        source: &ShaderSource,
        specialization: Specialization,
        resources: &[(&str, Binding)],
        grid: Grid,
    ) -> Result<Pass> {
        let roots = self.buffers.roots.map(|roots| ("roots", roots.now.into()));
        let specialization = specialization.feature("roots", roots.is_some());
        let resources: Vec<_> = resources.iter().copied().chain(roots).collect();
        self.pass(source, &specialization, &resources, grid)
    }

    /// A pass over the vertices of the guides as the grid of a volume sees them, which pushes them or only looks.
    fn pass_of_volume(
        &mut self,
        source: &ShaderSource,
        volume: &Volume,
        pushes: bool,
        resources: &[(&str, Binding)],
    ) -> Result<Pass> {
        let buffers = self.buffers;
        let specialization = Specialization::new()
            .feature("colliders", self.shared.colliders.is_some())
            .feature("push", pushes)
            .feature("rods", buffers.rods.is_some());
        let common = [("volume", volume.buffers.volume.into()), ("positions", buffers.strands.positions.into())];
        let resources = [&common[..], resources].concat();
        let grid = Grid::for_threads(buffers.strands.shape.guide_vertices(), GROUP);
        match buffers.rods {
            // They keep what they have moved by in the world, whatever their roots do.
            Some(rods) => {
                self.pass(source, &specialization, &[&resources[..], &[("rods", rods.state.into())]].concat(), grid)
            }
            None => {
                let resources = [&resources[..], &[("previous", buffers.previous.into())]].concat();
                self.pass_with_roots(source, specialization, &resources, grid)
            }
        }
    }

    /// A thread a guide.
    fn guides(&self) -> Grid {
        Grid::for_threads(self.buffers.strands.shape.guides, GROUP)
    }

    /// A thread a vertex of any strand: along x the guides, along y what each of them has, itself and its follow strands, along
    /// z the vertices. Where there are too many guides, a thread does the work of several.
    fn strand_vertices(&self) -> Grid {
        let shape = &self.buffers.strands.shape;
        let groups = shape.guides.div_ceil(GROUP).clamp(1, Grid::MAX_GROUPS);
        Grid([groups, 1 + shape.follows, shape.vertices])
    }
}
