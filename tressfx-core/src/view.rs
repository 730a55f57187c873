//! Where a picture is taken from, and rigid poses.

mod camera;
mod lens;
mod pose;

use glam::{Mat4, Vec2};

use crate::backend::DepthOrder;

pub use camera::Camera;
pub use lens::Lens;
pub use pose::{Pose, PoseError};

/// A part of a target that is drawn to, in pixels from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Viewport {
    offset: [u32; 2],
    size: [u32; 2],
    target: [u32; 2],
}

impl Viewport {
    /// All of a target of this size.
    pub fn whole(target: [u32; 2]) -> Self {
        Self { offset: [0, 0], size: target, target }
    }

    /// A part of a target of the size `target`.
    ///
    /// # Errors
    /// [`ViewError::Viewport`] if it leaves the target.
    pub fn part(offset: [u32; 2], size: [u32; 2], target: [u32; 2]) -> Result<Self, ViewError> {
        let fits = |axis: usize| offset[axis].checked_add(size[axis]).is_some_and(|end| end <= target[axis]);
        if fits(0) && fits(1) {
            Ok(Self { offset, size, target })
        } else {
            Err(ViewError::Viewport { offset, size, target })
        }
    }

    /// Its upper left corner.
    pub fn offset(&self) -> [u32; 2] {
        self.offset
    }

    /// Its width and height.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Width and height of the target.
    pub fn target(&self) -> [u32; 2] {
        self.target
    }

    /// Whether it has no pixel.
    pub fn is_empty(&self) -> bool {
        self.size.contains(&0)
    }
}

impl From<[u32; 2]> for Viewport {
    fn from(target: [u32; 2]) -> Self {
        Self::whole(target)
    }
}

/// Why something cannot be drawn from a view.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// A number of the matrices is NaN or infinite.
    #[error("view: the matrices hold numbers that are not finite")]
    NotFinite,
    /// Space is flattened: there is no picture.
    #[error("view: the matrices are singular, or their projection is neither perspective nor orthographic")]
    Singular,
    /// Depth is not the same across planes that face the eye, as with an oblique near plane.
    #[error("view: depth changes across the picture; a projection with an oblique near plane cannot be used")]
    Depth,
    /// Depth falls where it should rise.
    #[error("view: the depth of the projection is not in {0:?} order")]
    Order(DepthOrder),
    /// The near plane of a perspective is at the eye, or behind it.
    #[error("view: the near plane is at the distance {0}, it must be in front of the eye")]
    Near(f64),
    /// The viewport leaves the target.
    #[error("view: a viewport of {size:?} at {offset:?} leaves the target of {target:?}")]
    Viewport {
        /// Its upper left corner.
        offset: [u32; 2],
        /// Its width and height.
        size: [u32; 2],
        /// Width and height of the target.
        target: [u32; 2],
    },
}

/// From where, through which lens, and to which part of a target a picture is taken.
///
/// Clip space is that of WebGPU: y up, z from 0 to 1. It is made from the matrices of an engine, or by a [`Camera`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    view: Mat4,
    projection: Mat4,
    previous: [Mat4; 2],
    jitter: [Vec2; 2],
    viewport: Viewport,
    depth: DepthOrder,
    lens: Lens,
}

impl View {
    /// A view from the matrices that the scene is drawn with: world to view and view to clip, applied from the left.
    ///
    /// The view matrix may move, turn, mirror, scale and shear, with either hand. The projection may be a perspective or
    /// orthographic, off-axis, jittered, turned, mirrored, with a far plane that is infinitely far. `depth` says which end
    /// of the range of depth is near. Where the viewport has no pixel, matrices are not looked at.
    ///
    /// # Errors
    /// [`ViewError`]: what cannot be drawn, and why.
    pub fn new(
        view: Mat4,
        projection: Mat4,
        depth: DepthOrder,
        viewport: impl Into<Viewport>,
    ) -> Result<Self, ViewError> {
        let viewport = viewport.into();
        let lens =
            if viewport.is_empty() { Lens::default() } else { Lens::new(view, projection, depth, viewport.size())? };
        Ok(Self { view, projection, previous: [view, projection], jitter: [Vec2::ZERO; 2], viewport, depth, lens })
    }

    /// The same view, with the matrices that the frame before was drawn with, in the same order of depth and for as many pixels.
    #[must_use]
    pub fn with_previous(self, view: Mat4, projection: Mat4) -> Self {
        Self { previous: [view, projection], ..self }
    }

    /// The same view, where the projection of this frame moves the picture by `now` and that of the frame before moved it by `previous`,
    /// in pixels to the right and down: motion is measured without them.
    #[must_use]
    pub fn with_jitter(self, now: Vec2, previous: Vec2) -> Self {
        Self { jitter: [now, previous], ..self }
    }

    /// World to view.
    pub fn view_matrix(&self) -> Mat4 {
        self.view
    }

    /// View to clip.
    pub fn projection_matrix(&self) -> Mat4 {
        self.projection
    }

    /// World to clip: what the scene must be drawn with.
    pub fn view_projection(&self) -> Mat4 {
        self.projection * self.view
    }

    /// World to clip in the frame before; that of this frame where nothing else was given.
    pub fn previous_view_projection(&self) -> Mat4 {
        self.previous[1] * self.previous[0]
    }

    /// World to view and view to clip in the frame before; those of this frame where nothing else was given.
    pub fn previous_matrices(&self) -> [Mat4; 2] {
        self.previous
    }

    /// Pixels to the right and down by which the projections of this frame and of the one before move the picture.
    pub fn jitter(&self) -> [Vec2; 2] {
        self.jitter
    }

    /// Where the picture goes.
    pub fn viewport(&self) -> Viewport {
        self.viewport
    }

    /// Width and height of the picture in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.viewport.size
    }

    /// Whether there is nothing to draw to: a window that is minimised.
    pub fn is_empty(&self) -> bool {
        self.viewport.is_empty()
    }

    /// Which end of the range of depth is near.
    pub fn depth(&self) -> DepthOrder {
        self.depth
    }

    /// What the matrices do, taken apart.
    pub fn lens(&self) -> &Lens {
        &self.lens
    }
}
