//! The views of a frame on the GPU.

use tressfx_core::backend::Backend;
use tressfx_core::error::Result;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;
use tressfx_core::uniform_array::UniformArray;
use tressfx_core::view::View;

use crate::lights::Lights;
use crate::region::Region;
use crate::renderer::Targets;
use crate::uniforms::ViewUniform;

/// Views that one frame can have.
pub const MAX_VIEWS: usize = 8;

/// A view in a frame.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct ViewDraw<'a> {
    /// From where.
    pub view: &'a View,
    /// In which light.
    pub lights: &'a Lights,
    /// Into which textures.
    pub targets: Targets,
}

impl<'a> ViewDraw<'a> {
    /// A view of the strands.
    pub fn new(view: &'a View, lights: &'a Lights, targets: Targets) -> Self {
        Self { view, lights, targets }
    }
}

/// A view as passes bind it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundView<'a> {
    /// Which view of the frame it is.
    pub(crate) index: usize,
    /// [`ViewUniform`].
    pub(crate) uniform: Binding,
    /// Pixels of the viewport.
    pub(crate) size: [u32; 2],
    /// Where in it hair may be.
    pub(crate) region: Region,
    pub(crate) view: &'a View,
}

/// [`ViewUniform`] of each view.
#[derive(Debug)]
pub(crate) struct Views(UniformArray<ViewUniform>);

impl Views {
    pub(crate) fn new(backend: &mut dyn Backend) -> Result<Self> {
        UniformArray::new(backend, "hair.render.views", MAX_VIEWS).map(Self)
    }

    /// Uploads the views of a frame.
    pub(crate) fn upload(&self, list: &mut PassList, views: &[ViewDraw], regions: &[Region]) {
        let uniform = |draw: &ViewDraw, region: &Region| ViewUniform {
            first_tile: region.first,
            ..ViewUniform::new(draw.view, draw.lights)
        };
        let uniforms: Vec<_> = views.iter().zip(regions).map(|(draw, region)| uniform(draw, region)).collect();
        self.0.upload(list, 0, &uniforms);
    }

    pub(crate) fn bound<'a>(&self, index: usize, view: &'a View, region: Region) -> BoundView<'a> {
        BoundView { index, uniform: self.0.binding(index), size: view.size(), region, view }
    }
}
