//! The kernels: one file of WGSL in `shaders/`, one function here and one in [`crate::reference`], all of the same name.
//!
//! What a kernel does to the vertices of a strand is in functions beside its entry point, which read and write no buffers of
//! strands, so that a kernel that does the work of several can import them.

pub(crate) mod collide;
pub(crate) mod direct;
pub(crate) mod integrate;
pub(crate) mod lengths;
pub(crate) mod local_shape;
pub(crate) mod recovery;
pub(crate) mod roots;
pub(crate) mod tangents;
pub(crate) mod wind;

use std::sync::Arc;

use tressfx_core::Result;
use tressfx_core::backend::{Backend, ComputeDesc};
use tressfx_core::pass::{Grid, PassList};
use tressfx_core::shader::{Binding, Bindings, Kernel, Module, Shader, ShaderSource, Specialization};

use crate::buffers::{STEPS, SectionBuffers};
use crate::section::Shared;

/// Threads of a group; `package::grid::GROUP` in WGSL.
const GROUP: u32 = 64;

/// The WGSL modules that the kernels share.
pub(crate) const LIBRARY: &[Module] = &[
    ("capsule", include_str!("../shaders/capsule.wgsl")),
    ("joint", include_str!("../shaders/joint.wgsl")),
    ("rod", include_str!("../shaders/rod.wgsl")),
    ("rod_contact", include_str!("../shaders/rod_contact.wgsl")),
    ("root", include_str!("../shaders/root.wgsl")),
    ("step", include_str!("../shaders/step.wgsl")),
    ("vector", include_str!("../shaders/vector.wgsl")),
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

    /// A thread a guide.
    fn guides(&self) -> Grid {
        Grid::for_threads(self.buffers.strands.shape.guides, GROUP)
    }

    /// A thread a vertex of a guide: along z the vertices.
    fn guide_vertices(&self) -> Grid {
        let Grid([x, y, _]) = self.guides();
        Grid([x, y, self.buffers.strands.shape.vertices])
    }

    /// A thread a vertex of any strand: along x the guides, along y what each of them has, itself and its follow strands, along
    /// z the vertices. Where there are too many guides, a thread does the work of several.
    fn strand_vertices(&self) -> Grid {
        let shape = &self.buffers.strands.shape;
        let groups = shape.guides.div_ceil(GROUP).clamp(1, Grid::MAX_GROUPS);
        Grid([groups, 1 + shape.follows, shape.vertices])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The work of several kernels in one, on the vertices of a strand in registers.
    const FUSED: &str = "
        import package::integrate::{moved_on, shocked};
        import package::lengths::{Placing, Window, place, sweep};
        import package::local_shape::{BentEdge, bent};
        import package::root::root_of;
        import package::step::step;
        import package::tangents::{Neighborhood, beside, directions};
        import package::vector::DOWN;
        import package::wind::{across_edge, wind_of};

        @group(0) @binding(1) var<storage, read_write> strand: array<vec4<f32>>;

        @compute @workgroup_size(1)
        fn fused() {
            let root = root_of(0u);
            let last = shocked(root, strand[0].xyz);
            let free = moved_on(root, last, DOWN, shocked(root, strand[1].xyz)) + across_edge(wind_of(0u), DOWN);
            let edge = bent(BentEdge(root.rotation, vec4(last, 0.0), vec4(free, 1.0)), DOWN);
            var window: Window;
            var placing = Placing(edge.here, last, vec3(0.0), vec3(0.0), DOWN);
            sweep(&window, edge.next, 1.0, 1u);
            strand[1] = vec4(place(&placing, window.vertices[SWEEPS], window.lengths[SWEEPS], last, last, false), 1.0);
            strand[0] = placing.parent;
            let follow = beside(Neighborhood(DOWN, placing.parent.xyz, DOWN), DOWN, 1u);
            strand[2] = vec4(directions(follow, 1u), 0.0);
        }";

    #[test]
    fn one_kernel_can_do_the_work_of_several() {
        let kernels = [integrate::SOURCE, lengths::SOURCE, local_shape::SOURCE, tangents::SOURCE, wind::SOURCE];
        let library: Vec<Module> = LIBRARY.iter().copied().chain(kernels.map(|source| source.root)).collect();
        let text = format!("import package::constants::SWEEPS;\n{FUSED}");
        let source = ShaderSource { label: "test.fused", root: ("fused", text.leak()), library: Vec::leak(library) };
        for (roots, follows) in [(false, false), (false, true), (true, true)] {
            let specialization = Specialization::new()
                .constant("SWEEPS", 1)
                .constant("CHUNK", 1)
                .feature("global_shape", true)
                .feature("pinned_tips", false)
                .feature("roots", roots)
                .feature("follows", follows);
            Shader::new(&source, &specialization).unwrap();
        }
    }
}
