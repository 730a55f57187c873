//! Grooms (hair of a character) from files or generated from a seed, and the meshes that the hair grows on.
//!
//! [`read`] recognises the format by the content of a file, never by its name, and gives a [`HairAsset`], whatever the
//! format. The page of each format's module says what of a file is not kept.
//! The crate uses no GPU: `tressfx_core::strands::Strands` prepares an asset for the GPU.

#![forbid(unsafe_code)]

mod binary;
mod error;
mod kind;
mod report;
mod tokenizer;
mod write;

pub mod bones;
pub mod builtin;
pub mod character;
pub mod grow;
pub mod hair;
pub mod mesh;
pub mod obj;
pub mod pc2;
pub mod text;
pub mod tfxmesh;
pub mod tfxskin;
pub mod tressfx3;
pub mod tressfx4;

use std::path::Path;

use tressfx_core::asset::{AssetFormat, HairAsset};

pub use error::{FileError, FileErrorKind};
pub use kind::FileKind;
pub use report::{LengthStats, Oddities, Report};
pub use write::{WriteFormat, dropped_by, write};

/// Reads a groom file of any format that [`read_bytes`] knows.
///
/// # Errors
/// Those of [`read_bytes`], and if the file cannot be read.
pub fn read(path: impl AsRef<Path>) -> Result<HairAsset, FileError> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| FileError::new(&name, "file", FileErrorKind::Io(error)))?;
    read_bytes(&name, &bytes)
}

/// Reads a groom from memory; `name` stands for it in messages. The format is recognised by the content.
///
/// # Errors
/// Where the format is unknown, or the content contradicts itself, is cut off, or holds a value that is not finite.
/// The error names the file, the place in it and the field.
pub fn read_bytes(name: &str, bytes: &[u8]) -> Result<HairAsset, FileError> {
    match detect(bytes) {
        Some(AssetFormat::Hair) => hair::read(name, bytes),
        Some(AssetFormat::TressFx3) => tressfx3::read(name, bytes),
        Some(AssetFormat::TressFx4) => tressfx4::read(name, bytes),
        Some(AssetFormat::Text) => text::read(name, bytes),
        Some(AssetFormat::Obj) => obj::read(name, bytes),
        Some(AssetFormat::Builtin) | None => Err(FileError::new(name, "format", FileErrorKind::UnknownFormat).at(0)),
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
        let word = tokenizer::first_word(bytes)?;
        if text::is_first_word(word) {
            Some(AssetFormat::Text)
        } else {
            obj::is_first_word(word).then_some(AssetFormat::Obj)
        }
    }
}
