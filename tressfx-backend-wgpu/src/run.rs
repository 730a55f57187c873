//! Running a list on the backend's queue.

use tressfx_core::backend::{Record, Run};
use tressfx_core::error::Result;
use tressfx_core::pass::PassList;

use crate::WgpuBackend;

impl Run for WgpuBackend {
    fn run(&mut self, list: &PassList) -> Result<()> {
        let mut encoder = self.guarded("run", 0, |backend| {
            Ok(backend.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default()))
        })?;
        self.record(&mut encoder, list)?;
        self.guarded("run", 0, |backend| {
            backend.queue.submit([encoder.finish()]);
            Ok(())
        })?;
        self.loss.poll(&self.device, wgpu::PollType::wait_indefinitely())
    }
}
