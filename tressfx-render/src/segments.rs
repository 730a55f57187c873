//! Passes that turn segments of strands into fragments, and what becomes of those: that is the technique's.

use tressfx_core::backend::{Backend, Blend, Format, RasterDesc};
use tressfx_core::error::{Label, Result};
use tressfx_core::id::{BufferId, TextureId};
use tressfx_core::pass::{Draw, Grid, Load, PassList, RasterPass};
use tressfx_core::shader::{Binding, Kernel, Module, RasterPipeline, Specialization};

use crate::bound::Bound;
use crate::occlusion::{Listed, Occluded};
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

/// Two shaders that do the same: their labels and the modules with their entry points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shaders {
    pub(crate) compute: (Label, Module),
    /// None where nothing is gained by the raster units.
    pub(crate) raster: Option<(Label, Module)>,
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

/// How a pipeline of [`Segments`] is made.
#[derive(Debug)]
struct Recipe {
    fill: Fill,
    shaders: Shaders,
    specialization: Specialization,
    /// Format of the picture.
    target: Format,
}

impl Recipe {
    /// Of all segments before the scene, or of those of lists before what is opaque.
    fn make(&self, backend: &mut dyn Backend, is_listed: bool) -> Result<Walk> {
        let specialization = self.specialization.clone().feature("listed", is_listed).feature("occluded", is_listed);
        let library = self.shaders.library;
        let pipeline = match (self.fill, self.shaders.raster) {
            (Fill::Raster, Some((label, root))) => {
                let shader = shader(label, root, library, &specialization)?;
                Pipeline::Raster(backend.create_raster(&RasterDesc::new(shader).target(self.target, Blend::Over))?)
            }
            _ => {
                let (label, root) = self.shaders.compute;
                let specialization = walking(backend, &specialization);
                Pipeline::Compute(compute(backend, label, root, library, &specialization)?)
            }
        };
        Ok(Walk { pipeline, bound: Bound::new() })
    }
}

/// A pipeline, and its bindings by view, section, scene and the place of its list.
#[derive(Debug)]
pub(crate) struct Walk {
    pipeline: Pipeline,
    bound: Bound<(usize, BufferId, TextureId, Option<[u64; 2]>)>,
}

/// Such a pass.
#[derive(Debug)]
pub(crate) struct Segments {
    recipe: Recipe,
    all: Walk,
    /// The same over lists, once it was needed.
    listed: Option<Walk>,
}

impl Segments {
    /// A raster pass needs a target: it is the picture, of the format `target`, which the pass leaves as it is.
    pub(crate) fn new(
        backend: &mut dyn Backend,
        fill: Fill,
        shaders: Shaders,
        specialization: &Specialization,
        target: Format,
    ) -> Result<Self> {
        let recipe = Recipe { fill, shaders, specialization: specialization.clone(), target };
        Ok(Self { all: recipe.make(backend, false)?, listed: None, recipe })
    }

    /// The same, with what it takes to walk lists where those will be walked.
    pub(crate) fn with_lists(mut self, backend: &mut dyn Backend, are_walked: bool) -> Result<Self> {
        if are_walked {
            self.listed = Some(self.recipe.make(backend, true)?);
        }
        Ok(self)
    }

    /// Makes what it takes to walk lists, unless it is there, and changes nothing yet.
    pub(crate) fn prepare_lists(&self, backend: &mut dyn Backend) -> Result<Option<Walk>> {
        if self.listed.is_none() { self.recipe.make(backend, true).map(Some) } else { Ok(None) }
    }

    /// Walks lists with what was prepared.
    pub(crate) fn walk_lists(&mut self, prepared: Option<Walk>) {
        if prepared.is_some() {
            self.listed = prepared;
        }
    }

    fn walks(&mut self) -> impl Iterator<Item = &mut Walk> {
        std::iter::once(&mut self.all).chain(&mut self.listed)
    }

    pub(crate) fn begin_frame(&mut self) {
        self.walks().for_each(|walk| walk.bound.begin_frame());
    }

    /// Forgets what it has bound: it has been replaced.
    pub(crate) fn forget_bindings(&mut self) {
        self.walks().for_each(|walk| walk.bound.clear());
    }

    /// Writes the passes of all sections: over what is `occluded`, where that is known. `own` is what the technique binds, beside what the strands do.
    pub(crate) fn passes(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        draws: &[SectionDraw],
        targets: &Targets,
        own: &[(&'static str, Binding)],
        occluded: Option<&Occluded>,
    ) -> Result<()> {
        let (walk, occluded) = match (&mut self.listed, occluded) {
            (Some(walk), Some(occluded)) => (walk, Some(occluded)),
            _ => (&mut self.all, None),
        };
        let scene = occluded.map_or(targets.depth, |occluded| occluded.depth);
        let listed = |index: usize| occluded.map(|occluded| &occluded.lists[index]);
        let key = |index: usize, draw: &SectionDraw| {
            (view.index, draw.strands.colors, scene, listed(index).map(Listed::place))
        };
        let all = |index: usize, draw: &SectionDraw| {
            let mut all = [&draw.strands.bindings(view, scene)[..], own].concat();
            all.extend(listed(index).map(Listed::binding));
            all
        };
        let Walk { pipeline, bound } = walk;
        match pipeline {
            Pipeline::Compute(kernel) => {
                for (index, draw) in draws.iter().enumerate() {
                    let bindings = bound.get(key(index, draw), || kernel.bind(&all(index, draw)))?;
                    match listed(index) {
                        Some(&Listed { groups: (buffer, offset), .. }) => {
                            list.compute_indirect(kernel, &bindings, buffer, offset);
                        }
                        None => list.compute(kernel, &bindings, Grid::for_threads(draw.segments(), GROUP)),
                    }
                }
            }
            Pipeline::Raster(pipeline) => {
                let mut pass = RasterPass::new(pipeline.label()).color(targets.color, Load::Keep);
                for (index, draw) in draws.iter().enumerate() {
                    let bindings = bound.get(key(index, draw), || pipeline.bind(&all(index, draw)))?;
                    pass = pass.draw(match listed(index) {
                        Some(&Listed { draw: (buffer, offset), .. }) => {
                            Draw::indirect(pipeline, &bindings, buffer, offset)
                        }
                        None => Draw::new(pipeline, &bindings, 6 * draw.segments(), 1),
                    });
                }
                list.raster(pass);
            }
        }
        Ok(())
    }

    #[cfg(test)]
    pub(crate) fn shader(&self) -> &tressfx_core::shader::Shader {
        match &self.all.pipeline {
            Pipeline::Compute(kernel) => &kernel.shader,
            Pipeline::Raster(pipeline) => &pipeline.shader,
        }
    }
}
