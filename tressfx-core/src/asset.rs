//! Hair assets: what a groom file holds, before it is prepared for the GPU.
//!
//! This is the data alone, whatever it comes from; the crate `tressfx-asset` reads and writes files and grows built-in
//! grooms. [`crate::strands::Strands`] is made from an asset.

mod check;
mod error;
mod inverse_mass;
mod own_look;
mod placement;

use std::fmt;

use serde::Serialize;

pub use check::{Domain, Values};
pub use error::{AssetError, AssetProblem};
pub use placement::Placement;

/// The most vertices that a strand of a binary TressFX file, or a strand made for the GPU, may have.
pub const MAX_VERTICES: u32 = 256;
/// The fewest vertices that a strand of a binary TressFX file, or a strand made for the GPU, may have.
pub const MIN_VERTICES: u32 = 2;

/// Where an asset came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AssetFormat {
    /// Text `.tfx` of 2013, or its later variant with header keys ("version 2.0").
    Text,
    /// Binary `.tfx` of TressFX 3 (296-byte header).
    TressFx3,
    /// Binary `.tfx` of TressFX 4 (160-byte header).
    TressFx4,
    /// `.hair`, the exchange format of Cem Yuksel's hair models.
    Hair,
    /// Wavefront `.obj` whose line elements are the strands.
    Obj,
    /// Made by a program, not read from a file.
    Builtin,
}

impl fmt::Display for AssetFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Text => "TressFX text",
            Self::TressFx3 => "TressFX 3 binary",
            Self::TressFx4 => "TressFX 4 binary",
            Self::Hair => "HAIR",
            Self::Obj => "Wavefront OBJ",
            Self::Builtin => "built-in",
        })
    }
}

/// The header of a `.hair` file: what holds wherever the file has no array.
#[derive(Clone, Debug, PartialEq)]
pub struct HairDefaults {
    /// Segments of a strand.
    pub segments: u32,
    /// Thickness (a diameter, in the unit of the points).
    pub thickness: f32,
    /// 0 is opaque, 1 is invisible.
    pub transparency: f32,
    /// RGB.
    pub color: [f32; 3],
    /// Free text of the author, padded with zeros.
    pub info: [u8; 88],
}

/// A groom as a file describes it: strands of any vertex count, root first, in the unit of the file.
///
/// Arrays "per strand" have `counts.len()` entries, arrays "per vertex" have `points.len()` entries, and the vertices of
/// all strands are concatenated. [`HairAsset::check`] says whether this holds.
#[derive(Clone, Debug, PartialEq)]
pub struct HairAsset {
    /// The file's name, or the name of a built-in groom. Appears in messages only.
    pub name: String,
    /// The format that it was read from.
    pub format: AssetFormat,
    /// The version that the file states, where it states one.
    pub version: Option<f32>,
    /// The raw points of all strands, without [`HairAsset::placement`].
    pub points: Vec<[f32; 3]>,
    /// Vertices of each strand, at least 1. Their sum is `points.len()`.
    /// A strand of one vertex, or of more than [`MAX_VERTICES`], is kept here and resampled when strands are made.
    pub counts: Vec<u32>,
    /// Inverse mass per vertex (0 is pinned), where the file has it.
    pub inverse_mass: Option<Vec<f32>>,
    /// Texture coordinates of the root, per strand.
    pub strand_uvs: Option<Vec<[f32; 2]>>,
    /// The third texture coordinate that some text files have, per strand.
    pub strand_w: Option<Vec<f32>>,
    /// Texture coordinates per vertex.
    pub vertex_uvs: Option<Vec<[f32; 2]>>,
    /// Thickness per strand, 0 or more; in which unit files do not say.
    pub strand_thickness: Option<Vec<f32>>,
    /// Thickness per vertex, 0 or more.
    pub vertex_thickness: Option<Vec<f32>>,
    /// Transparency per vertex, 0 to 1 (0 is opaque).
    pub vertex_transparency: Option<Vec<f32>>,
    /// RGBA per vertex, 0 to 1.
    pub vertex_colors: Option<Vec<[f32; 4]>>,
    /// TressFX 3: the index of the guide, per strand.
    pub guide_index: Option<Vec<u32>>,
    /// Whether the tips are pinned as well (the last two vertices of a strand).
    pub both_ends_immovable: bool,
    /// The flag "is sorted" of a text file.
    pub sorted: Option<bool>,
    /// The vertex count that a text 2.0 header asks for.
    pub max_vertices: Option<u32>,
    /// Follow strands per guide that the header asks for.
    pub follow_count: Option<u32>,
    /// Radius around the guide in which follow strands are placed, that the header asks for.
    pub follow_radius: Option<f32>,
    /// Where a text 2.0 header places the points.
    pub placement: Option<Placement>,
    /// The header of a `.hair` file.
    pub hair_defaults: Option<HairDefaults>,
}

impl HairAsset {
    /// An asset of points and vertex counts alone. Not checked: see [`HairAsset::check`].
    pub fn new(name: impl Into<String>, format: AssetFormat, points: Vec<[f32; 3]>, counts: Vec<u32>) -> Self {
        Self {
            name: name.into(),
            format,
            version: None,
            points,
            counts,
            inverse_mass: None,
            strand_uvs: None,
            strand_w: None,
            vertex_uvs: None,
            strand_thickness: None,
            vertex_thickness: None,
            vertex_transparency: None,
            vertex_colors: None,
            guide_index: None,
            both_ends_immovable: false,
            sorted: None,
            max_vertices: None,
            follow_count: None,
            follow_radius: None,
            placement: None,
            hair_defaults: None,
        }
    }

    /// Number of strands.
    pub fn strand_count(&self) -> usize {
        self.counts.len()
    }

    /// The vertices of each strand in turn, as ranges of the arrays per vertex.
    pub fn ranges(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        self.counts.iter().scan(0usize, |start, &count| {
            let range = *start..*start + count as usize;
            *start = range.end;
            Some(range)
        })
    }

    /// The vertex count that all strands share, if they do.
    pub fn uniform_count(&self) -> Option<u32> {
        let first = *self.counts.first()?;
        self.counts.iter().all(|&count| count == first).then_some(first)
    }

    /// The points where the header places them; borrowed where it moves nothing.
    pub fn placed_points(&self) -> std::borrow::Cow<'_, [[f32; 3]]> {
        match self.placement {
            Some(placement) if !placement.is_identity() => placement.apply(&self.points).into(),
            _ => self.points.as_slice().into(),
        }
    }
}
