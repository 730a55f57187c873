//! GPU time of each pass, from timestamps at its two ends.

use std::collections::VecDeque;

use tressfx_core::backend::Timing;
use tressfx_core::hazards::accesses;
use tressfx_core::id::Resource;
use tressfx_core::pass::PassList;

use crate::read::Mapped;

/// A query set holds so many timestamps at most.
const MAX_QUERIES: u32 = wgpu::QUERY_SET_MAX_QUERIES;

/// Frames whose times nobody fetched are forgotten beyond this number.
const MAX_PENDING: usize = 8;

/// Times the passes of lists, where the device can.
#[derive(Debug)]
pub(crate) struct Timer {
    /// Nanoseconds of one tick; `None` where the device cannot time.
    period: Option<f32>,
    pending: VecDeque<Finished>,
}

/// A list that is being recorded.
#[derive(Debug)]
pub(crate) struct Frame {
    /// The passes, without their times.
    timings: Vec<Timing>,
    used: u32,
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    copy: Mapped,
}

/// A list whose timestamps are on their way.
#[derive(Debug)]
struct Finished {
    timings: Vec<Timing>,
    copy: Mapped,
}

impl Timer {
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let able = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        Self { period: able.then(|| queue.get_timestamp_period()), pending: VecDeque::new() }
    }

    /// Queries for every pass of `list`; `None` where there is nothing to time, or more than one query set holds.
    pub(crate) fn begin(
        &self,
        device: &wgpu::Device,
        list: &PassList,
        bytes_of: impl Fn(Resource) -> u64,
    ) -> Option<Frame> {
        self.period?;
        let timings: Vec<Timing> = list
            .passes()
            .map(|(label, command)| {
                let bytes = accesses(command).into_iter().map(|(resource, _)| bytes_of(resource)).sum();
                Timing { label, begin: 0.0, nanoseconds: 0.0, bytes, invocations: None }
            })
            .collect();
        let count = 2 * timings.len() as u32;
        if !(1..=MAX_QUERIES).contains(&count) {
            return None;
        }
        let bytes = u64::from(count) * u64::from(wgpu::QUERY_SIZE);
        Some(Frame {
            timings,
            used: 0,
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("hair.timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count,
            }),
            resolved: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("hair.timestamps"),
                size: bytes,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            copy: Mapped::new(device, bytes),
        })
    }

    pub(crate) fn end(&mut self, encoder: &mut wgpu::CommandEncoder, frame: Frame) {
        encoder.resolve_query_set(&frame.queries, 0..frame.used, &frame.resolved, 0);
        encoder.copy_buffer_to_buffer(&frame.resolved, 0, frame.copy.buffer(), 0, frame.resolved.size());
        frame.copy.map_on_submit(encoder);
        self.pending.push_back(Finished { timings: frame.timings, copy: frame.copy });
        if self.pending.len() > MAX_PENDING {
            self.pending.pop_front();
        }
    }

    /// The newest list whose times have arrived; older ones are forgotten.
    pub(crate) fn collect(&mut self, device: &wgpu::Device) -> Vec<Timing> {
        let Some(period) = self.period else { return Vec::new() };
        for index in (0..self.pending.len()).rev() {
            let finished = &mut self.pending[index];
            let Some(bytes) = finished.copy.bytes(device) else { continue };
            let ticks: Vec<u64> =
                bytes.chunks_exact(8).map(|tick| u64::from_le_bytes(tick.try_into().expect("8 bytes"))).collect();
            drop(bytes);
            let mut timings = std::mem::take(&mut finished.timings);
            for (timing, ends) in timings.iter_mut().zip(ticks.chunks_exact(2)) {
                let nanoseconds = |from: u64, to: u64| to.saturating_sub(from) as f64 * f64::from(period);
                timing.begin = nanoseconds(ticks[0], ends[0]);
                timing.nanoseconds = nanoseconds(ends[0], ends[1]);
            }
            self.pending.drain(..=index);
            return timings;
        }
        Vec::new()
    }
}

impl Frame {
    fn next(&mut self) -> [Option<u32>; 2] {
        self.used += 2;
        [Some(self.used - 2), Some(self.used - 1)]
    }

    pub(crate) fn compute_writes(&mut self) -> wgpu::ComputePassTimestampWrites<'_> {
        let [beginning_of_pass_write_index, end_of_pass_write_index] = self.next();
        let query_set = &self.queries;
        wgpu::ComputePassTimestampWrites { query_set, beginning_of_pass_write_index, end_of_pass_write_index }
    }

    pub(crate) fn raster_writes(&mut self) -> wgpu::RenderPassTimestampWrites<'_> {
        let [beginning_of_pass_write_index, end_of_pass_write_index] = self.next();
        let query_set = &self.queries;
        wgpu::RenderPassTimestampWrites { query_set, beginning_of_pass_write_index, end_of_pass_write_index }
    }
}
