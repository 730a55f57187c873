//! Commands of a list become commands of a wgpu encoder.

use std::vec::IntoIter;

use tressfx_core::backend::Record;
use tressfx_core::error::Result;
use tressfx_core::pass::{Command, ComputePass, Count, Grid, Groups, Load, PassList, RasterPass};

use crate::WgpuBackend;
use crate::pipeline::Stage;
use crate::read::Rows;
use crate::timer::Frame;
use crate::uploads::Uploads;

/// All that can fail to be made: it is there before the first command is written.
struct Prepared {
    uploads: Uploads,
    frame: Option<Frame>,
    /// In the order of the list.
    bind_groups: IntoIter<wgpu::BindGroup>,
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

    fn encode_compute(&self, encoder: &mut wgpu::CommandEncoder, pass: &ComputePass, prepared: &mut Prepared) {
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(pass.kernel.label()),
            timestamp_writes: prepared.frame.as_mut().map(Frame::compute_writes),
        });
        let Stage::Compute(pipeline) = &self.catalog.pipeline(pass.kernel.pipeline).stage else { return };
        // Groups of an encoder may span command buffers, which lavapipe does not survive; those of a pass do not.
        if let Some(scope) = &pass.scope {
            compute.push_debug_group(scope);
        }
        compute.set_pipeline(pipeline);
        compute.set_bind_group(0, prepared.bind_groups.next().as_ref(), &[]);
        match pass.groups {
            Groups::Grid(Grid([x, y, z])) => compute.dispatch_workgroups(x, y, z),
            Groups::Indirect { buffer, offset } => {
                compute.dispatch_workgroups_indirect(self.catalog.buffer(buffer), offset);
            }
        }
        if pass.scope.is_some() {
            compute.pop_debug_group();
        }
    }

    fn encode_raster(&self, encoder: &mut wgpu::CommandEncoder, pass: &RasterPass, prepared: &mut Prepared) {
        let color = |[r, g, b, a]: [f32; 4]| {
            let [r, g, b, a] = [r, g, b, a].map(f64::from);
            wgpu::Color { r, g, b, a }
        };
        let targets = pass.colors.iter();
        let colors: Vec<_> = targets
            .map(|&(texture, load)| {
                Some(wgpu::RenderPassColorAttachment {
                    view: &self.catalog.texture(texture).view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: operations(load, color),
                })
            })
            .collect();
        let depth = pass.depth.map(|(texture, load)| wgpu::RenderPassDepthStencilAttachment {
            view: &self.catalog.texture(texture).view,
            depth_ops: Some(operations(load, |depth| depth)),
            stencil_ops: None,
        });
        let mut raster = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(pass.label),
            color_attachments: &colors,
            depth_stencil_attachment: depth,
            timestamp_writes: prepared.frame.as_mut().map(Frame::raster_writes),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        if let Some(scope) = &pass.scope {
            raster.push_debug_group(scope);
        }
        if let Some(viewport) = pass.viewport {
            let ([x, y], [width, height]) = (viewport.origin, viewport.size);
            raster.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
            raster.set_scissor_rect(x, y, width, height);
        }
        for draw in &pass.draws {
            let Stage::Raster(pipeline) = &self.catalog.pipeline(draw.pipeline.pipeline).stage else { return };
            raster.set_pipeline(pipeline);
            raster.set_bind_group(0, prepared.bind_groups.next().as_ref(), &[]);
            match draw.count {
                Count::Direct { vertices, instances } => raster.draw(0..vertices, 0..instances),
                Count::Indirect { buffer, offset } => raster.draw_indirect(self.catalog.buffer(buffer), offset),
            }
        }
        if pass.scope.is_some() {
            raster.pop_debug_group();
        }
    }
}

fn operations<T: Copy, U>(load: Load<T>, convert: impl Fn(T) -> U) -> wgpu::Operations<U> {
    let load = match load {
        Load::Keep => wgpu::LoadOp::Load,
        Load::Clear(value) => wgpu::LoadOp::Clear(convert(value)),
    };
    wgpu::Operations { load, store: wgpu::StoreOp::Store }
}
