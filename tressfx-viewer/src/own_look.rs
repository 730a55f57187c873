//! Colours and widths that grooms bring along, and pictures over them: `--root-texture` and `--strand-texture`.

use std::path::Path;

use anyhow::{Context, Result};
use image::ImageReader;
use tressfx_core::strands::Strands;
use tressfx_render::{ColorTexture, OwnLook};

use crate::cli::Render;

/// The pictures of the command line.
pub(crate) struct Textures {
    root: Option<ColorTexture>,
    strand: Option<ColorTexture>,
}

impl Textures {
    /// Reads those that were asked for.
    pub(crate) fn read(args: &Render) -> Result<Self> {
        let of = |path: &Option<_>| path.as_deref().map(read).transpose();
        Ok(Self { root: of(&args.root_texture)?, strand: of(&args.strand_texture)? })
    }

    /// Whether none was asked for.
    pub(crate) fn are_none(&self) -> bool {
        self.root.is_none() && self.strand.is_none()
    }

    /// What a section brings along, with the pictures over it.
    pub(crate) fn look(&self, strands: &Strands) -> Result<OwnLook> {
        let mut look = OwnLook::of(strands);
        if let Some(texture) = &self.root {
            look = look.with_root_texture(strands, texture)?;
        }
        if let Some(texture) = &self.strand {
            look = look.with_strand_texture(strands, texture);
        }
        Ok(look)
    }
}

/// A picture as sRGB of 8 bits. The crate refuses what would take more than 512 MiB.
fn read(path: &Path) -> Result<ColorTexture> {
    let named = || path.display().to_string();
    let reader = ImageReader::open(path).with_context(named)?.with_guessed_format().with_context(named)?;
    let image = reader.decode().with_context(named)?.into_rgba8();
    let texels = image.as_raw().as_chunks::<4>().0.to_vec();
    ColorTexture::new([image.width(), image.height()], texels).with_context(named)
}
