//! What wgpu asks for beyond the rules of the contract.

use tressfx_core::error::{Error, Result};
use tressfx_core::id::TextureId;
use tressfx_core::pass::{Command, PassList};

use crate::WgpuBackend;
use crate::reads::Rows;

impl WgpuBackend {
    /// Holds a list, which keeps the rules of the contract, against the limits of the device.
    ///
    /// # Errors
    /// [`Error::Rule`] with the first command that exceeds one.
    pub(crate) fn check_limits(&self, list: &PassList) -> Result<()> {
        for (index, command) in list.commands().iter().enumerate() {
            let fits = match command {
                Command::ReadTexture { src, .. } => self.fits_copy(*src),
                Command::Upload { .. }
                | Command::Clear { .. }
                | Command::Copy { .. }
                | Command::CopyToTexture { .. }
                | Command::Compute(_)
                | Command::Raster(_)
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
}
