//! Why hair is not drawn.

use glam::Vec3;
use tressfx_core::error::Error;
use tressfx_core::strand_buffers::StrandShape;
use tressfx_core::view::PoseError;

use crate::copies::MAX_COPIES;
use crate::lights::{Cone, LightPlace, Lights, MAX_LIGHTS};
use crate::lod::Lod;
use crate::strands::SectionDraw;

/// Why hair is not drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawError {
    /// More views than the renderer was made for.
    #[error("hair.render: {given} views, a frame can have {most}")]
    Views {
        /// How many there are.
        given: usize,
        /// [`RenderDesc::views`](crate::RenderDesc::views).
        most: usize,
    },
    /// More lights than a view can have.
    #[error("hair.render: {0} lights, a view can have {MAX_LIGHTS}")]
    Lights(usize),
    /// The cone of a light is none.
    #[error(
        "hair.render: light {light} shines along {along} into a cone from {inner} to {outer} radians: it takes a direction, and 0 <= inner < outer <= pi"
    )]
    Cone {
        /// Which light.
        light: usize,
        /// Its direction.
        along: Vec3,
        /// The angle up to which light is full.
        inner: f32,
        /// The angle from which on there is none.
        outer: f32,
    },
    /// A view is larger than what the renderer was made for.
    #[error("hair.render: a view of {view:?} pixels, the renderer was made for {renderer:?}")]
    Size {
        /// The view's size.
        view: [u32; 2],
        /// The renderer's.
        renderer: [u32; 2],
    },
    /// A view names no texture for depth and coverage of the hair.
    #[error(
        "hair.render: the renderer was made to write depth and coverage of hair (`hair_output`), a view has no target for them"
    )]
    NoHairTarget,
    /// A view names a texture for depth and coverage of the hair that the renderer does not write.
    #[error(
        "hair.render: a view has a target for depth and coverage of hair, the renderer was made without `hair_output`"
    )]
    UnusedHairTarget,
    /// A view names no texture for the motion of hair.
    #[error(
        "hair.render: the renderer was made to write the motion of hair (`velocity_output`), a view has no target for it"
    )]
    NoVelocityTarget,
    /// A view names a texture for the motion of hair that the renderer does not write.
    #[error("hair.render: a view has a target for the motion of hair, the renderer was made without `velocity_output`")]
    UnusedVelocityTarget,
    /// Strands have no room for where they were.
    #[error("hair.render: strands have no room for the positions of the frame before (`ShadedStrands::with_past`)")]
    NoPast,
    /// Strands bring colours of their own along that the renderer knows nothing of.
    #[error("hair.render: strands bring colours of their own along, the renderer was made without `own_colors`")]
    OwnColors,
    /// A material has a number of copies, or a spread of them, that cannot be drawn.
    #[error(
        "hair.render: a material has {copies} `copies` with a `copy_spread` of {spread}, it may have 1 to {MAX_COPIES} and 0 or more"
    )]
    CopyCount {
        /// How many.
        copies: u32,
        /// How far they are moved, m.
        spread: f32,
    },
    /// A section has too many vertices to be counted by the GPU, its copies among them.
    #[error("hair.render: a section of {0} vertices, with its copies, there can be {MAX_VERTICES}")]
    Vertices(u64),
    /// A material asks for copies of strands, of which the renderer knows nothing.
    #[error("hair.render: a material has `copies`, the renderer was made without them (`RenderDesc::copies`)")]
    Copies,
    /// The matrices of the frame before, or the jitter of a view, are not finite.
    #[error("hair.render: the matrices of the frame before, or the jitter, hold numbers that are not finite")]
    PreviousView,
    /// The pose of a section is not valid.
    #[error("hair.render: {0}")]
    Pose(#[from] PoseError),
    /// The level of detail of a section is not valid.
    #[error(
        "hair.render: a level of detail of {share} of the strands in steps of {step}: it takes a share above 0 and up to 1, and steps of at least 1"
    )]
    Lod {
        /// Of the strands.
        share: f32,
        /// Between vertices.
        step: u32,
    },
    /// A rule of the contract is broken, or the device fails.
    #[error(transparent)]
    Backend(#[from] Error),
}

/// The most vertices of a section, with its copies: fragment shaders draw each of its segments as two triangles.
const MAX_VERTICES: u64 = u32::MAX as u64 / 6;

/// Whether a section can be drawn like this.
pub(crate) fn check_section(draw: &SectionDraw) -> Result<(), DrawError> {
    draw.pose.validate()?;
    let (copies, spread) = (draw.material.copies, draw.material.copy_spread);
    let can_be_drawn = (1..=MAX_COPIES).contains(&copies) && spread >= 0.0 && spread.is_finite();
    if !can_be_drawn {
        return Err(DrawError::CopyCount { copies, spread });
    }
    let StrandShape { guides, follows, vertices } = draw.strands.buffers.shape;
    let vertices = [1 + follows, copies, vertices].into_iter().map(u64::from).fold(guides.into(), u64::saturating_mul);
    if vertices > MAX_VERTICES {
        return Err(DrawError::Vertices(vertices));
    }
    let Lod { share, step } = draw.lod;
    if draw.lod.is_valid() { Ok(()) } else { Err(DrawError::Lod { share, step }) }
}

/// Whether a view can have these lights.
pub(crate) fn check_lights(lights: &Lights) -> Result<(), DrawError> {
    if lights.lights.len() > MAX_LIGHTS {
        return Err(DrawError::Lights(lights.lights.len()));
    }
    let mut cones = lights.lights.iter().enumerate().filter_map(|(light, of)| match of.place {
        LightPlace::Point { cone: Some(cone), .. } => Some((light, cone)),
        _ => None,
    });
    match cones.find(|(_, cone)| !cone.is_valid()) {
        Some((light, Cone { along, inner, outer })) => Err(DrawError::Cone { light, along, inner, outer }),
        None => Ok(()),
    }
}
