//! Commands of a list become commands of a wgpu encoder.

use std::vec::IntoIter;

use tressfx_core::backend::Record;
use tressfx_core::error::Result;
use tressfx_core::pass::{Command, PassList};

use crate::WgpuBackend;
use crate::reads::Rows;
use crate::timer::Frame;
use crate::uploads::Uploads;

/// All that can fail to be made: it is there before the first command is written.
pub(crate) struct Prepared {
    uploads: Uploads,
    pub(crate) frame: Option<Frame>,
    /// In the order of the list.
    pub(crate) bind_groups: IntoIter<wgpu::BindGroup>,
    reads: IntoIter<(wgpu::Buffer, Rows)>,
}

impl Record for WgpuBackend {
    type Encoder = wgpu::CommandEncoder;

    /// The encoder is one of this backend's device.
    fn record(&mut self, encoder: &mut wgpu::CommandEncoder, list: &PassList) -> Result<()> {
        self.sweep();
        self.catalog.check(list)?;
        self.check_limits(list)?;
        self.check()?;
        let mut prepared = self.prepare(list)?;
        for command in list.commands() {
            self.encode(encoder, command, &mut prepared);
        }
        if let Some(frame) = prepared.frame {
            self.timer.end(&self.device, encoder, frame);
        }
        self.uploads.give_back(encoder, prepared.uploads);
        Ok(())
    }
}

impl WgpuBackend {
    fn prepare(&mut self, list: &PassList) -> Result<Prepared> {
        self.reads.collect_discarded();
        Ok(Prepared {
            uploads: self.fill_uploads(list.bytes())?,
            frame: self.begin_timing(list)?,
            bind_groups: self.prepare_bind_groups(list)?.into_iter(),
            reads: self.prepare_reads(list)?.into_iter(),
        })
    }

    fn encode(&mut self, encoder: &mut wgpu::CommandEncoder, command: &Command, prepared: &mut Prepared) {
        match command {
            Command::Upload { dst, offset, data } => {
                prepared.uploads.copy(encoder, data, self.catalog.buffer(*dst), *offset);
            }
            Command::Clear { dst, offset, bytes } => {
                encoder.clear_buffer(self.catalog.buffer(*dst), *offset, Some(*bytes));
            }
            Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                let (src, dst) = (self.catalog.buffer(*src), self.catalog.buffer(*dst));
                encoder.copy_buffer_to_buffer(src, *src_offset, dst, *dst_offset, *bytes);
            }
            Command::CopyToTexture { src, offset, row_bytes, dst } => {
                let (buffer, texture) = (self.catalog.buffer(*src), &self.catalog.texture(*dst).texture);
                let layout = wgpu::TexelCopyBufferLayout {
                    offset: *offset,
                    bytes_per_row: Some(*row_bytes),
                    rows_per_image: None,
                };
                encoder.copy_buffer_to_texture(
                    wgpu::TexelCopyBufferInfo { buffer, layout },
                    texture.as_image_copy(),
                    wgpu::Extent3d { width: texture.width(), height: texture.height(), depth_or_array_layers: 1 },
                );
            }
            Command::Compute(pass) => self.encode_compute(encoder, pass, prepared),
            Command::Raster(pass) => self.encode_raster(encoder, pass, prepared),
            Command::ReadBuffer { src, offset, bytes, ticket } => {
                let Some(read) = prepared.reads.next() else { return };
                encoder.copy_buffer_to_buffer(self.catalog.buffer(*src), *offset, &read.0, 0, *bytes);
                self.expect_read(encoder, read, *ticket);
            }
            Command::ReadTexture { src, ticket } => {
                let Some(read) = prepared.reads.next() else { return };
                self.encode_read_texture(encoder, *src, &read);
                self.expect_read(encoder, read, *ticket);
            }
            _ => unreachable!("limits.rs refuses what is not known here"),
        }
    }
}
