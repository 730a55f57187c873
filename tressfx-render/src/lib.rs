//! Rendering of hair: compute kernels shade strands, turn them into fragments of pixels, and sort the fragments of each
//! pixel.
//!
//! ```text
//! hair.render.shadow_bounds     compute  one thread eight vertices: the box of the hair as each light sees   HairRenderer
//! hair.render.shadow_splat      compute  one thread a strand segment: what it takes of the light in cells   HairRenderer
//! hair.render.shadow_sum        compute  one thread a row of cells: what is taken up to each                HairRenderer
//! hair.render.shadow_sky        compute  32 threads a cell: what arrives there from everywhere              HairRenderer
//! hair.render.shadow_light      compute  one thread a strand vertex: what arrives there of sky and lights   HairRenderer
//! hair.render.shadow_opaque     compute  one thread a strand vertex: what the opaque scene leaves of lights HairRenderer
//! hair.render.shade             compute  one thread a strand vertex: its colour as the view sees it         HairRenderer
//!
//! hair.render.occlusion_mass    compute  one thread a strand segment of a sample: how much hair tiles have  skips_hidden
//! hair.render.occlusion_guess   compute  one thread a tile: between which depths it may be opaque           skips_hidden
//! hair.render.occlusion_list    compute  four segments a thread, twice: those that may be seen              skips_hidden
//! hair.render.occlusion_sums    compute  one thread a listed segment: optical depths of parts of pixels     skips_hidden
//! hair.render.occlusion_depth   compute  one thread a pixel: from where on its hair is opaque               skips_hidden
//!
//! hair.render.nearest           compute  one thread a strand segment: the K nearest, where lists are bounded Technique::Ppll
//! hair.render.fill              compute  one thread a strand segment: its fragments into the pixels' lists  Technique::Ppll
//! hair.render.resolve           compute  one thread a pixel: the K nearest sorted, the rest summed up       Technique::Ppll
//!
//! hair.render.shortcut_depths   compute  one thread a strand segment: the K nearest depths of pixels        Technique::ShortCut
//! hair.render.shortcut_colors   compute  one thread a strand segment: colours down to the last depth        Technique::ShortCut
//! hair.render.shortcut_resolve  compute  one thread a pixel: their mean, or in order                        Technique::ShortCut
//!
//! hair.render.tile_points       compute  one thread a strand vertex: on the screen, all sections in one row Technique::Tiles
//! hair.render.tile_depth        compute  eight threads a tile: the farthest that the scene shows            Technique::Tiles
//! hair.render.tile_bin          compute  one thread a segment, twice: counted and referred to from tiles    Technique::Tiles
//! hair.render.tile_alloc        compute  eight threads a tile: where its references go                      Technique::Tiles
//! hair.render.tile_blend        compute  a group a tile: its fragments in order                             Technique::Tiles
//! hair.render.tile_reopen       compute  one thread a tile: those that are drawn again, with all hair       Technique::Tiles
//!
//! hair.render.composite         raster   tiles of pixels with hair: blended over the caller's picture       every technique
//! hair.render.composite_compute compute  one thread a pixel of such tiles: the same, with storage_target    every technique
//!
//! hair.render.seen_keys         compute  one thread a strand segment: the fragment a pixel is seen to have  velocity_output
//! hair.render.seen_segments     compute  one thread a strand segment: which segment that is of              velocity_output
//! hair.render.velocity          raster   tiles of pixels with hair: how far it has moved                    velocity_output
//! ```
//!
//! With [`Fill::Raster`] raster passes with two triangles a strand segment do what the compute passes over segments do. Their
//! labels end in `_raster`.
//!
//! The last column says what writes the pass. This crate writes passes into a [`PassList`](tressfx_core::pass::PassList). It
//! names no backend, submits nothing and reads nothing back unless the caller asks. Each compute kernel is one WGSL file,
//! one Rust file and one f64 function in [`mod@reference`], all of the same name.

#![forbid(unsafe_code)]

mod auto;
mod bound;
mod composite;
mod copies;
mod counters;
mod draw_error;
mod fibre;
mod lights;
mod lod;
mod look;
mod material;
mod occlusion;
mod output;
mod own_look;
mod places;
mod ppll;
mod predict;
mod reach;
pub mod reference;
mod region;
mod renderer;
mod resolved;
mod scattering;
mod segments;
mod shade;
mod shaders;
mod shadow;
mod shortcut;
mod strands;
mod technique;
mod tiles;
pub mod uniforms;
mod usage;
mod velocity;
mod views;

pub use auto::AutoDesc;
pub use counters::Counters;
pub use draw_error::DrawError;
pub use fibre::{FibreScattering, Pigment};
pub use lights::{Cone, Light, LightPlace, Lights, MAX_LIGHTS, OpaqueDepth, STORED_LIGHTS};
pub use lod::{Bends, Lod, LodDesc};
pub use look::{Look, NoLook};
pub use material::{Highlight, Material, MaterialError};
pub use output::HAIR_FORMAT;
pub use own_look::{ColorTexture, ColorTextureError, NoRootUvs, OwnLook};
pub use places::PLACES;
pub use ppll::{K_RANGE, PpllDesc, Tail};
pub use reach::Drawn;
pub use renderer::{HairRenderer, RenderDesc, Targets};
pub use resolved::TILE;
pub use segments::Fill;
pub use shaders::VIEW_MODULE;
pub use shadow::{SHADOW_MODULES, ShadowDesc};
pub use shortcut::ShortCutDesc;
pub use strands::{SectionDraw, ShadedStrands, StrandInfo};
pub use technique::Technique;
pub use tiles::TilesDesc;
pub use velocity::VELOCITY_FORMAT;
pub use views::{MAX_VIEWS, ViewDraw};
