//! What wgpu asks for beyond the rules of the contract.

use tressfx_core::backend::Format;
use tressfx_core::error::{Error, Label, Result};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Command, PassList, RasterPass};

use crate::WgpuBackend;
use crate::reads::Rows;
use crate::tables::texture_format;

impl WgpuBackend {
    /// Holds a list, which keeps the rules of the contract, against the limits of the device.
    ///
    /// # Errors
    /// [`Error::Rule`] with the first command that exceeds one.
    pub(crate) fn check_limits(&self, list: &PassList) -> Result<()> {
        for (index, command) in list.commands().iter().enumerate() {
            let fits = match command {
                Command::Raster(pass) => self.fits_pass(pass),
                Command::ReadTexture { src, .. } => self.fits_copy(*src),
                Command::Upload { .. }
                | Command::Clear { .. }
                | Command::Copy { .. }
                | Command::CopyToTexture { .. }
                | Command::Compute(_)
                | Command::ReadBuffer { .. } => Ok(()),
                _ => Err(String::from("this backend does not know the command")),
            };
            fits.map_err(|message| Error::rule(format!("command {index}, {}", command.name()), message))?;
        }
        Ok(())
    }

    /// A texture comes back by way of a buffer, whose rows are padded.
    fn fits_copy(&self, src: TextureId) -> Result<(), String> {
        let most = self.catalog.caps().max_buffer_bytes;
        let bytes = self.catalog.texture_desc(src).map_or(0, |desc| Rows::of_texture(desc.size, desc.format).total());
        match bytes <= most {
            true => Ok(()),
            false => Err(format!("{bytes} bytes come back, a buffer holds {most}")),
        }
    }

    fn fits_pass(&self, pass: &RasterPass) -> Result<(), String> {
        let formats = pass.colors.iter().filter_map(|(id, _)| self.catalog.texture_desc(*id));
        let formats: Vec<_> = formats.map(|desc| desc.format).collect();
        self.fits_texel(&formats)
    }

    /// # Errors
    /// [`Error::Rule`] if a pass into such targets has too much to write for a pixel.
    pub(crate) fn fits_targets(&self, label: Label, formats: &[Format]) -> Result<()> {
        self.fits_texel(formats).map_err(|message| Error::rule(label, message))
    }

    fn fits_texel(&self, formats: &[Format]) -> Result<(), String> {
        let mut bytes = 0u32;
        for &format in formats {
            let format = texture_format(format).map_err(|error| error.to_string())?;
            let aligned = bytes.next_multiple_of(format.target_component_alignment().unwrap_or(1));
            bytes = aligned + format.target_pixel_byte_cost().unwrap_or(0);
        }
        match bytes <= self.target_bytes {
            true => Ok(()),
            false => Err(format!("{bytes} bytes for each pixel of the targets, the device has {}", self.target_bytes)),
        }
    }
}
