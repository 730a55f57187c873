//! Hair assets: what a groom file holds, before it is prepared for the GPU.
//!
//! [`read`] tells the format by the content of a file, never by its name, and gives one [`HairAsset`], whatever the format.
//! Nothing that a known format stores is lost on the way in. [`crate::strands::Strands`] is made from an asset.

mod bytes;
mod check;
mod error;
mod inverse_mass;
mod lines;
mod report;
mod write;

pub mod hair;
pub mod obj_lines;
pub mod text;
pub mod tressfx3;
pub mod tressfx4;

use std::fmt;
use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};
use serde::Serialize;

pub use error::{AssetError, AssetErrorKind};
pub(crate) use report::segment_length;
pub use report::{LengthStats, Oddities, Report};
pub use write::{WriteFormat, write};

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
    ObjLines,
    /// Made by [`crate::builtin`].
    Builtin,
}

impl fmt::Display for AssetFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Text => "TressFX text",
            Self::TressFx3 => "TressFX 3 binary",
            Self::TressFx4 => "TressFX 4 binary",
            Self::Hair => "HAIR",
            Self::ObjLines => "Wavefront OBJ lines",
            Self::Builtin => "built-in",
        })
    }
}

/// The placement that the header of a text 2.0 file asks for: scaled first, then turned, then moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Uniform factor.
    pub scale: f32,
    /// Degrees about x, then about y, then about z.
    pub rotation: [f32; 3],
    /// In the unit of the scaled points.
    pub translation: [f32; 3],
}

impl Default for Placement {
    fn default() -> Self {
        Self { scale: 1.0, rotation: [0.0; 3], translation: [0.0; 3] }
    }
}

impl Placement {
    /// True where [`Placement::apply`] would change no point.
    pub fn is_identity(&self) -> bool {
        *self == Self::default()
    }

    fn affine(&self) -> DAffine3 {
        let [x, y, z] = self.rotation.map(|degrees| f64::from(degrees).to_radians());
        let rotation = DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
        let translation = DVec3::from_array(self.translation.map(f64::from));
        DAffine3::from_mat3_translation(rotation * f64::from(self.scale), translation)
    }

    /// The placed points. Computed in f64, so that a large translation costs no precision before the last rounding.
    pub fn apply(&self, points: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let affine = self.affine();
        points
            .iter()
            .map(|p| affine.transform_point3(DVec3::from_array(p.map(f64::from))).as_vec3().to_array())
            .collect()
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
    pub colour: [f32; 3],
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
    /// Thickness per strand.
    pub strand_thickness: Option<Vec<f32>>,
    /// Thickness per vertex.
    pub vertex_thickness: Option<Vec<f32>>,
    /// Transparency per vertex (0 is opaque).
    pub vertex_transparency: Option<Vec<f32>>,
    /// RGBA per vertex.
    pub vertex_colours: Option<Vec<[f32; 4]>>,
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
            vertex_colours: None,
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

/// Reads a groom file of any format that [`read_bytes`] knows.
///
/// # Errors
/// As [`read_bytes`], or where the file cannot be read.
pub fn read(path: impl AsRef<Path>) -> Result<HairAsset, AssetError> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| AssetError::new(&name, "file", AssetErrorKind::Io(error)))?;
    read_bytes(&name, &bytes)
}

/// Reads a groom from memory; `name` is what messages call it. The content alone tells the format.
///
/// # Errors
/// Where the format is unknown, or the content contradicts itself, is cut off, or holds a value that is not finite.
/// The error names the file, the place in it and the field.
pub fn read_bytes(name: &str, bytes: &[u8]) -> Result<HairAsset, AssetError> {
    match detect(bytes) {
        Some(AssetFormat::Hair) => hair::read(name, bytes),
        Some(AssetFormat::TressFx3) => tressfx3::read(name, bytes),
        Some(AssetFormat::TressFx4) => tressfx4::read(name, bytes),
        Some(AssetFormat::Text) => text::read(name, bytes),
        Some(AssetFormat::ObjLines) => obj_lines::read(name, bytes),
        Some(AssetFormat::Builtin) | None => Err(AssetError::new(name, "format", AssetErrorKind::UnknownFormat).at(0)),
    }
}

/// Tells the format of a file by its first bytes: the magic of `.hair`, the float version of the binary `.tfx` files, or
/// the first word of a text.
fn detect(bytes: &[u8]) -> Option<AssetFormat> {
    let magic: [u8; 4] = bytes.first_chunk().copied()?;
    let version = f32::from_le_bytes(magic);
    if magic == hair::MAGIC {
        Some(AssetFormat::Hair)
    } else if tressfx3::VERSIONS.contains(&version) {
        Some(AssetFormat::TressFx3)
    } else if tressfx4::VERSIONS.contains(&version) {
        Some(AssetFormat::TressFx4)
    } else {
        let word = lines::first_word(bytes)?;
        if text::is_first_word(word) {
            Some(AssetFormat::Text)
        } else {
            obj_lines::is_first_word(word).then_some(AssetFormat::ObjLines)
        }
    }
}
