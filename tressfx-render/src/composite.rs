//! `hair.render.composite` and `hair.render.composite_compute`: the resolved hair over the caller's picture.

use tressfx_core::backend::{Backend, Blend, Format, RasterDesc};
use tressfx_core::error::{Error, Result};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Draw, Grid, Load, PassList, RasterPass};
#[cfg(test)]
use tressfx_core::shader::Shader;
use tressfx_core::shader::{Kernel, Module, RasterPipeline, Specialization};

use crate::bound::Bound;
use crate::output::{HAIR_FORMAT, Output};
use crate::renderer::Targets;
use crate::resolved::{Resolved, tile_count};
use crate::shaders::{CORNER, SHARED, compute, shader, with_shared};
use crate::views::BoundView;

const LABEL: &str = "hair.render.composite";
const COMPUTE: &str = "hair.render.composite_compute";

const LIBRARY: &[Module] = &with_shared::<1, 19>([CORNER]);

/// Groups that lay tiles over the picture, at most: each takes one after the other.
const MOST_GROUPS: u32 = 4096;

/// Quads over the tiles with hair, or groups of threads, which engines can choose where compute passes can write their picture.
#[derive(Debug)]
enum Way {
    Raster(RasterPipeline),
    Compute(Kernel),
}

#[derive(Debug)]
pub(crate) struct Composite {
    way: Way,
    /// By view, and by picture where bindings name it.
    pub(crate) bound: Bound<(usize, Option<TextureId>)>,
}

impl Composite {
    pub(crate) fn new(backend: &mut dyn Backend, output: Output) -> Result<Self> {
        let way = if output.storage {
            Way::Compute(over_in_compute(backend, output)?)
        } else {
            Way::Raster(over_in_raster(backend, output)?)
        };
        Ok(Self { way, bound: Bound::new() })
    }

    #[cfg(test)]
    pub(crate) fn shader(&self) -> &Shader {
        match &self.way {
            Way::Raster(pipeline) => &pipeline.shader,
            Way::Compute(kernel) => &kernel.shader,
        }
    }

    pub(crate) fn pass(
        &mut self,
        list: &mut PassList,
        view: &BoundView,
        resolved: &Resolved,
        targets: &Targets,
    ) -> Result<()> {
        let &BoundView { index, size, .. } = view;
        let shared = [("view", view.uniform), ("tiles", resolved.tiles.into()), ("resolved", resolved.colors.into())];
        match &self.way {
            Way::Raster(pipeline) => {
                let bindings = self.bound.get((index, None), || pipeline.bind(&shared))?;
                let mut pass = RasterPass::new(LABEL).color(targets.color, Load::Keep);
                if let Some(hair) = targets.hair {
                    pass = pass.color(hair, Load::Keep);
                }
                list.raster(pass.draw(Draw::indirect(pipeline, &bindings, resolved.draw, 0)));
            }
            Way::Compute(kernel) => {
                let [uniform, tiles, colors] = shared;
                let [drawn, picture] = [("drawn", resolved.draw.into()), ("picture", targets.color.into())];
                let bindings = self
                    .bound
                    .get((index, Some(targets.color)), || kernel.bind(&[uniform, tiles, colors, drawn, picture]))?;
                list.compute(kernel, &bindings, Grid([tile_count(size).clamp(1, MOST_GROUPS), 1, 1]));
            }
        }
        Ok(())
    }
}

fn over_in_raster(backend: &mut dyn Backend, output: Output) -> Result<RasterPipeline> {
    let root = ("composite", include_str!("../shaders/composite.wgsl"));
    let shader = shader(LABEL, root, LIBRARY, &output.specialization())?;
    let mut desc = RasterDesc::new(shader).target(output.color, Blend::Over);
    if output.hair {
        desc = desc.target(HAIR_FORMAT, Blend::Replace);
    }
    backend.create_raster(&desc)
}

fn over_in_compute(backend: &mut dyn Backend, output: Output) -> Result<Kernel> {
    let half_floats = match output.color {
        Format::Rgba16F => true,
        Format::Rgba8 => false,
        other => return Err(Error::rule(COMPUTE, format!("{other:?} is no picture that a compute pass can write"))),
    };
    if output.hair {
        return Err(Error::rule(COMPUTE, "depth and coverage of the hair are drawn, not written by a compute pass"));
    }
    let root = ("composite_compute", include_str!("../shaders/composite_compute.wgsl"));
    compute(backend, COMPUTE, root, &SHARED, &Specialization::new().feature("half_floats", half_floats))
}
