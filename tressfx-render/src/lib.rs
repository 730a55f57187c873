//! Rendering of hair: an A-buffer of fragments that compute kernels fill from strands and resolve into a picture.
//!
//! ```text
//! hair.render.scene      raster   opaque meshes and the backdrop: colour and depth             ScenePass
//! hair.render.shade      compute  one thread a strand vertex: its colour                       HairRenderer
//! hair.render.fill       compute  one thread a strand segment: fragments into lists of pixels
//! hair.render.resolve    compute  one thread a pixel: the K nearest sorted, the rest summed up
//! hair.render.composite  raster   tiles with hair: over the caller's picture
//! ```
//!
//! This crate writes passes into a [`PassList`](tressfx_core::pass::PassList); it names no backend, submits nothing and
//! reads nothing back by itself. Each kernel is one WGSL file, one Rust file and one f64 [`mod@reference`] of the same name.

#![forbid(unsafe_code)]

mod composite;
mod fill;
pub mod gpu;
mod lights;
mod material;
mod openness;
mod pool;
mod predict;
pub mod reference;
mod renderer;
mod resolve;
mod scene;
mod section;
mod shade;
mod shaders;

pub use lights::{Light, LightPlace, Lights, MAX_LIGHTS};
pub use material::{Highlight, Material, MaterialError};
pub use pool::Counters;
pub use renderer::{HairRenderer, RenderDesc, Targets};
pub use resolve::{K_RANGE, TILE};
pub use scene::{Backdrop, MeshDraw, SceneMesh, ScenePass, Surface};
pub use section::{Section, SectionDraw, StrandInfo};
