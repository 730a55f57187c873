//! The truth that every technique of drawing hair is measured against: a slow renderer on the CPU, in f64, that shares no
//! code and no method with the fast ones.
//!
//! What it draws:
//!
//! * **A fibre is a solid.** Each segment is the union of all balls whose centre lies on the segment and whose radius goes
//!   linearly from one vertex to the other (a round cone); a strand is the union of its segments. Colour and opacity are
//!   linear along a segment, and the same all around it.
//! * **A pixel is the mean of its square** (a box filter), by rays through sample points. The points of a pixel are an R2
//!   sequence (Roberts 2018), shifted by a hash of the pixel (Cranley and Patterson 1976): any number of them is spread
//!   evenly, and neighbouring pixels do not repeat each other.
//! * **A layer** is what a ray passes in one piece within one strand: joints and round ends count once, a strand that the ray
//!   enters twice counts twice. Its colour and opacity are those at the point of the axis whose ball the ray enters first, its
//!   place is where the ray enters.
//! * **All layers of all strands are put in order by the exact distance** and blended front to back. A ray ends when less than
//!   1e-9 of what is behind can be seen. There is no limit to the number of layers.
//! * What is nearer than the near plane is cut off: a fibre that reaches through it begins there.
//! * A layer that begins behind the opaque scene is hidden. The scene has one depth a pixel, at its centre, as on the GPU.
//!
//! What it does not do: to compute how a fibre scatters light. Colours of vertices are given, so that a comparison with a
//! technique shows the error of its visibility alone; how well colours are computed is measured elsewhere.
//!
//! With [`Truth::lit_by`] it does compute how much light arrives. Given are the colours in each light alone and under a white
//! sky, where nothing shades:
//!
//! * **The light that comes from a direction** is the product of `1 - shadow_alpha` over all pieces of strands that a ray in
//!   that direction passes (a piece is what is one layer to a ray of a pixel), and 0 where the ray meets an opaque triangle or
//!   less than 1e-4 is left. The ray begins on the axis of the fibre, where the layer takes its colour. The piece that it
//!   begins in does not shade it, other pieces of the same strand do. Triangles within the fibre's radius do not, since a mesh
//!   that a strand grows on goes through its axis. What is behind a point light shades nothing.
//! * **The colour of a layer** is the sum, over all lights, of the colour in it times the light that comes from it, and the
//!   colour under a white sky times the mean, over all directions, of the light that comes from there and the radiance there.
//! * **Of the layers along a ray one is picked** with the probability of its weight in the blend, and stands for all; one
//!   direction stands for the sky. The mean of such pictures is the exact one. What is left to chance is an R3 sequence, shifted
//!   by a hash of the pixel, so that it is spread evenly over the rays of a pixel.
//!
//! Beside this truth, [`ShadowMethod::NearestFibre`] has a method to compare with: light by the nearest fibre that each light sees.
//!
//! [`Truth::new`] takes a view and sections, [`Truth::render`] gives a [`Picture`] with an estimate of its sampling error,
//! [`Truth::layers`] the layers along one ray. It takes 52 bytes a vertex, about 80 a pixel, and up to 256 MB for the lists of
//! segments: more work is done in several passes over the picture. Light takes 12 bytes a vertex for each light and for the sky,
//! and 61 for the tree of boxes; while that is built, about 300 in all. The result is the same on any number of threads.
//!
//! * M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018.
//! * R. Cranley and T. N. L. Patterson, Randomization of Number Theoretic Methods for Multiple Integration, SIAM Journal on
//!   Numerical Analysis 13(6), 1976.

#![forbid(unsafe_code)]

mod bound;
mod cone;
mod error;
mod fibres;
mod layer;
mod light;
mod lit;
mod nearest;
mod opaque;
mod pattern;
mod picture;
mod rays;
mod section;
mod shadow;
mod tile;
mod tiles;
mod tree;
mod truth;

pub use error::TruthError;
pub use layer::Layer;
pub use light::{Illumination, Light, LitSection, OpaqueMesh, ShadowMethod};
pub use pattern::sample_points;
pub use picture::{Picture, SamplingError};
pub use section::Section;
pub use truth::{Progress, Truth};
