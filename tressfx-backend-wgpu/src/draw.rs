//! Compute and raster passes.

use tressfx_core::pass::{ComputePass, Count, Grid, Groups, Load, RasterPass};

use crate::WgpuBackend;
use crate::pipeline::Stage;
use crate::record::Prepared;
use crate::timer::Frame;

impl WgpuBackend {
    pub(crate) fn encode_compute(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pass: &ComputePass,
        prepared: &mut Prepared,
    ) {
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

    pub(crate) fn encode_raster(&self, encoder: &mut wgpu::CommandEncoder, pass: &RasterPass, prepared: &mut Prepared) {
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
