//! Rendering of hair: compute kernels shade strands, walk them over the pixels of a view, and put what they leave there in
//! order.
//!
//! ```text
//! hair.render.shade      compute  one thread a strand vertex: its colour, seen from a view     HairRenderer
//! hair.render.fill       compute  one thread a strand segment: fragments into lists of pixels  Technique::Ppll
//! hair.render.resolve    compute  one thread a pixel: the K nearest sorted, the rest summed up
//! hair.render.composite  raster   tiles with hair: over the caller's picture
//! ```
//!
//! This crate writes passes into a [`PassList`](tressfx_core::pass::PassList); it names no backend, submits nothing and
//! reads nothing back by itself. Each kernel is one WGSL file, one Rust file and one f64 [`mod@reference`] of the same name.

#![forbid(unsafe_code)]

mod bound;
mod lights;
mod material;
mod ppll;
mod predict;
pub mod reference;
mod renderer;
mod shade;
mod shaders;
mod strands;
mod technique;
pub mod uniforms;
mod views;
mod visibility;

pub use lights::{Light, LightPlace, Lights, MAX_LIGHTS};
pub use material::{Highlight, Material, MaterialError};
pub use ppll::{Counters, K_RANGE, PpllDesc, TILE};
pub use renderer::{DrawError, HairRenderer, RenderDesc, Targets};
pub use shaders::VIEW_MODULE;
pub use strands::{SectionDraw, ShadedStrands, StrandInfo};
pub use technique::Technique;
pub use views::{MAX_VIEWS, ViewDraw};
