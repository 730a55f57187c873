//! Writing assets to files.

use std::path::Path;

use tressfx_core::asset::HairAsset;

use crate::{FileError, FileErrorKind, text, tressfx4};

/// A format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteFormat {
    /// Binary `.tfx` of TressFX 4: one vertex count for all strands.
    TressFx4,
    /// Text `.tfx`: any vertex counts.
    Text,
}

impl WriteFormat {
    /// The format that the extension of a path stands for: `.tfx` is TressFX 4 binary, `.txt` is text.
    pub fn of_path(path: impl AsRef<Path>) -> Option<Self> {
        let extension = path.as_ref().extension()?;
        if extension.eq_ignore_ascii_case("tfx") {
            Some(Self::TressFx4)
        } else {
            extension.eq_ignore_ascii_case("txt").then_some(Self::Text)
        }
    }
}

/// Writes an asset to a file, in the given format or else in the one that the extension stands for.
///
/// # Errors
/// Where the extension stands for no format, the format cannot hold the asset ([`tressfx4::to_bytes`],
/// [`text::to_bytes`]), or the file cannot be written.
pub fn write(path: impl AsRef<Path>, asset: &HairAsset, format: Option<WriteFormat>) -> Result<(), FileError> {
    let path = path.as_ref();
    let name = path.display().to_string();
    let format = format.or_else(|| WriteFormat::of_path(path)).ok_or_else(|| {
        let found = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let expected = ".tfx (TressFX 4 binary) or .txt (TressFX text)";
        FileError::new(&name, "extension", FileErrorKind::Unexpected { found, expected })
    })?;
    let bytes = match format {
        WriteFormat::TressFx4 => tressfx4::to_bytes(asset)?,
        WriteFormat::Text => text::to_bytes(asset)?,
    };
    std::fs::write(path, bytes).map_err(|error| FileError::new(&name, "file", FileErrorKind::Io(error)))
}

/// What the asset has and a file of this format cannot hold, for a message to the person who converts it.
pub fn dropped_by(asset: &HairAsset, format: WriteFormat) -> Vec<&'static str> {
    let text = format == WriteFormat::Text;
    let binary = !text;
    [
        ("inverse mass", asset.inverse_mass.is_some() && text),
        ("third texture coordinate", asset.strand_w.is_some() && (binary || asset.strand_uvs.is_none())),
        ("vertex UVs", asset.vertex_uvs.is_some() && text),
        ("strand thickness", asset.strand_thickness.is_some() && text),
        ("vertex thickness", asset.vertex_thickness.is_some() && (text || asset.strand_widths().is_none())),
        ("vertex transparency", asset.vertex_transparency.is_some() && text),
        ("vertex colours", asset.vertex_colors.is_some() && text),
        ("guide index", asset.guide_index.is_some()),
        ("sorted flag", asset.sorted.is_some() && binary),
        ("vertex count hint", asset.max_vertices.is_some() && binary),
        ("follow strand hints", (asset.follow_count.is_some() || asset.follow_radius.is_some()) && binary),
        ("HAIR defaults", asset.hair_defaults.is_some()),
    ]
    .into_iter()
    .filter_map(|(what, dropped)| dropped.then_some(what))
    .collect()
}

#[cfg(test)]
mod tests {
    use tressfx_core::asset::AssetFormat;

    use super::*;

    #[test]
    fn extensions_stand_for_formats() {
        assert_eq!(WriteFormat::of_path("a/b.TFX"), Some(WriteFormat::TressFx4));
        assert_eq!(WriteFormat::of_path("b.txt"), Some(WriteFormat::Text));
        assert_eq!(WriteFormat::of_path("b"), None);
    }

    #[test]
    fn what_a_format_cannot_hold_is_said() {
        let asset = HairAsset {
            sorted: Some(true),
            inverse_mass: Some(vec![0.0; 3]),
            ..HairAsset::new("f", AssetFormat::Text, vec![[0.0; 3]; 3], vec![1, 2])
        };
        assert_eq!(dropped_by(&asset, WriteFormat::TressFx4), ["sorted flag"]);
        assert_eq!(dropped_by(&asset, WriteFormat::Text), ["inverse mass"]);
        let error = tressfx4::to_bytes(&asset).expect_err("ragged").to_string();
        assert_eq!(
            error,
            "f: vertsPerStrand: strands have 1 to 2 vertices, but the format has one count for all: resample them first"
        );
        assert!(write("no.format", &asset, None).expect_err("no format").to_string().contains("extension"));
    }
}
