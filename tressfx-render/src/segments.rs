//! Passes that turn segments of strands into fragments, and what becomes of those: that is the technique's.

use tressfx_core::backend::{Backend, Blend, Format, RasterDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Draw, Grid, Load, PassList, RasterPass};
use tressfx_core::shader::{Binding, Kernel, Module, RasterPipeline, Specialization};

use crate::bound::Bound;
use crate::renderer::Targets;
use crate::shaders::{GROUP, compute, shader};
use crate::strands::SectionDraw;
use crate::views::BoundView;

/// What turns segments of strands into fragments. The picture is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fill {
    /// Compute passes: each thread walks the pixels of a segment.
    #[default]
    Compute,
    /// Raster passes: a quad covers each segment. The device must let fragment shaders write buffers
    /// ([`Caps::fragment_writes`](tressfx_core::backend::Caps::fragment_writes)).
    Raster,
}

/// The two shaders that do the same: their labels and the modules with their entry points.
pub(crate) struct Shaders {
    pub(crate) compute: (Label, Module),
    pub(crate) raster: (Label, Module),
    pub(crate) library: &'static [Module],
}

/// What a kernel is compiled for that walks over the pixels of segments (`walk.wgsl`): on a CPU, too, that those with ends have a loop of their own.
pub(crate) fn walking(backend: &dyn Backend, specialization: &Specialization) -> Specialization {
    specialization.clone().feature("ends_apart", backend.caps().is_cpu)
}

#[derive(Debug)]
enum Pipeline {
    Compute(Kernel),
    Raster(RasterPipeline),
}

/// Such a pass.
#[derive(Debug)]
pub(crate) struct Segments {
    pipeline: Pipeline,
    /// By view, section and scene.
    bound: Bound<(usize, BufferId, TextureId)>,
}

impl Segments {
    /// A raster pass needs a target: it is the picture, of the format `target`, which the pass leaves as it is.
    pub(crate) fn new(
        backend: &mut dyn Backend,
        fill: Fill,
        shaders: &Shaders,
        specialization: &Specialization,
        target: Format,
    ) -> Result<Self> {
        let pipeline = match fill {
            Fill::Compute => {
                let (label, root) = shaders.compute;
                let specialization = walking(backend, specialization);
                Pipeline::Compute(compute(backend, label, root, shaders.library, &specialization)?)
            }
            Fill::Raster => {
                let (label, root) = shaders.raster;
                let shader = shader(label, root, shaders.library, specialization)?;
                Pipeline::Raster(backend.create_raster(&RasterDesc::new(shader).target(target, Blend::Over))?)
            }
        };
        Ok(Self { pipeline, bound: Bound::new() })
    }

    /// A pass that has no raster pass beside it.
    pub(crate) fn compute(
        backend: &mut dyn Backend,
        label: Label,
        root: Module,
        library: &'static [Module],
        specialization: &Specialization,
    ) -> Result<Self> {
        let specialization = walking(backend, specialization);
        let kernel = compute(backend, label, root, library, &specialization)?;
        Ok(Self { pipeline: Pipeline::Compute(kernel), bound: Bound::new() })
    }

    pub(crate) fn begin_frame(&mut self) {
        self.bound.begin_frame();
    }

    /// Forgets what it has bound: it has been replaced.
    pub(crate) fn forget_bindings(&mut self) {
        self.bound.clear();
    }

    /// Writes the passes of all sections. `own` is what the technique binds, beside what the strands do.
    pub(crate) fn passes(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draws: &[SectionDraw],
        targets: &Targets,
        own: &[(&'static str, Binding)],
    ) -> Result<()> {
        let Self { pipeline, bound } = self;
        let key = |draw: &SectionDraw| (view.index, draw.strands.colors, targets.depth);
        let all = |draw: &SectionDraw| [&draw.strands.bindings(view, targets.depth)[..], own].concat();
        match pipeline {
            Pipeline::Compute(kernel) => {
                for draw in draws {
                    let bindings = bound.get(key(draw), || kernel.bind(&all(draw)))?;
                    let segments = draw.segments();
                    list.compute(kernel, &bindings, Grid::for_threads(segments, GROUP));
                }
            }
            Pipeline::Raster(pipeline) => {
                let mut pass = RasterPass::new(pipeline.label()).color(targets.color, Load::Keep);
                for draw in draws {
                    let bindings = bound.get(key(draw), || pipeline.bind(&all(draw)))?;
                    let segments = draw.segments();
                    pass = pass.draw(Draw::new(pipeline, &bindings, 6 * segments, 1));
                }
                list.raster(pass);
            }
        }
        Ok(())
    }

    #[cfg(test)]
    pub(crate) fn shader(&self) -> &tressfx_core::shader::Shader {
        match &self.pipeline {
            Pipeline::Compute(kernel) => &kernel.shader,
            Pipeline::Raster(pipeline) => &pipeline.shader,
        }
    }
}
