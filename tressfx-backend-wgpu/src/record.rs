//! Commands of a list become commands of a wgpu encoder.

use tressfx_core::backend::Record;
use tressfx_core::check::check;
use tressfx_core::error::Result;
use tressfx_core::pass::{Command, ComputePass, Grid, Groups, Load, PassList, RasterPass};
use wgpu::util::DeviceExt;

use crate::WgpuBackend;
use crate::pipeline::Stage;
use crate::timer::Frame;

impl Record for WgpuBackend {
    type Encoder = wgpu::CommandEncoder;

    fn record(&mut self, encoder: &mut wgpu::CommandEncoder, list: &PassList) -> Result<()> {
        check(list);
        self.check_lost()?;
        self.forget_lost_reads();
        // Uploads take effect in the order of the list, so they are copies in the encoder and not writes of the queue.
        let uploads = (!list.bytes.is_empty()).then(|| {
            self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("hair.uploads"),
                contents: &list.bytes,
                usage: wgpu::BufferUsages::COPY_SRC,
            })
        });
        let mut frame = self.timer.begin(&self.device, list, |resource| self.bytes(resource));
        for command in &list.commands {
            self.encode(encoder, command, uploads.as_ref(), frame.as_mut());
        }
        if let Some(frame) = frame {
            self.timer.end(encoder, frame);
        }
        Ok(())
    }
}

impl WgpuBackend {
    fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        command: &Command,
        uploads: Option<&wgpu::Buffer>,
        frame: Option<&mut Frame>,
    ) {
        match command {
            Command::Upload { dst, offset, data } => {
                let Some(uploads) = uploads.filter(|_| !data.is_empty()) else { return };
                let dst = self.buffer(*dst, "upload");
                encoder.copy_buffer_to_buffer(uploads, data.start as u64, dst, *offset, data.len() as u64);
            }
            Command::Clear { dst, offset, bytes } => {
                encoder.clear_buffer(self.buffer(*dst, "clear"), *offset, Some(*bytes));
            }
            Command::Copy { src, src_offset, dst, dst_offset, bytes } => {
                let (src, dst) = (self.buffer(*src, "copy"), self.buffer(*dst, "copy"));
                encoder.copy_buffer_to_buffer(src, *src_offset, dst, *dst_offset, *bytes);
            }
            Command::Compute(pass) => self.encode_compute(encoder, pass, frame),
            Command::Raster(pass) => self.encode_raster(encoder, pass, frame),
            Command::ReadBuffer { src, offset, bytes, ticket } => {
                self.encode_read_buffer(encoder, *src, *offset, *bytes, *ticket);
            }
            Command::ReadTexture { src, ticket } => self.encode_read_texture(encoder, *src, *ticket),
        }
    }

    fn encode_compute(&mut self, encoder: &mut wgpu::CommandEncoder, pass: &ComputePass, frame: Option<&mut Frame>) {
        let label = pass.kernel.label();
        self.prepare_bind_group(&pass.kernel, &pass.bindings);
        let Stage::Compute(pipeline) = &self.pipeline(pass.kernel.pipeline, label).stage else {
            panic!("{label}: a raster pipeline in a compute pass");
        };
        let mut compute = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: frame.map(Frame::compute_writes),
        });
        compute.set_pipeline(pipeline);
        compute.set_bind_group(0, self.bind_group(&pass.kernel, &pass.bindings), &[]);
        match pass.groups {
            Groups::Grid(Grid([x, y, z])) => compute.dispatch_workgroups(x, y, z),
            Groups::Indirect { buffer, offset } => {
                compute.dispatch_workgroups_indirect(self.buffer(buffer, label), offset);
            }
        }
    }

    fn encode_raster(&mut self, encoder: &mut wgpu::CommandEncoder, pass: &RasterPass, frame: Option<&mut Frame>) {
        for draw in &pass.draws {
            self.prepare_bind_group(&draw.kernel, &draw.bindings);
        }
        let colors: Vec<_> = pass
            .colors
            .iter()
            .map(|&(texture, load)| {
                Some(wgpu::RenderPassColorAttachment {
                    view: &self.texture(texture, pass.label).view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: operations(load, |[r, g, b, a]| {
                        let [r, g, b, a] = [r, g, b, a].map(f64::from);
                        wgpu::Color { r, g, b, a }
                    }),
                })
            })
            .collect();
        let depth = pass.depth.map(|(texture, load)| wgpu::RenderPassDepthStencilAttachment {
            view: &self.texture(texture, pass.label).view,
            depth_ops: Some(operations(load, |depth| depth)),
            stencil_ops: None,
        });
        let mut raster = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(pass.label),
            color_attachments: &colors,
            depth_stencil_attachment: depth,
            timestamp_writes: frame.map(Frame::raster_writes),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        for draw in &pass.draws {
            let label = draw.kernel.label();
            let Stage::Raster(pipeline) = &self.pipeline(draw.kernel.pipeline, label).stage else {
                panic!("{label}: a compute pipeline in a raster pass");
            };
            raster.set_pipeline(pipeline);
            raster.set_bind_group(0, self.bind_group(&draw.kernel, &draw.bindings), &[]);
            raster.draw(0..draw.vertices, 0..draw.instances);
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
