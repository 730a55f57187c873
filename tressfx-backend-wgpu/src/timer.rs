//! GPU time of each pass, from timestamps at its two ends.

use std::collections::VecDeque;

use tressfx_core::backend::Timing;
use tressfx_core::error::Result;
use tressfx_core::hazards::accesses;
use tressfx_core::pass::PassList;
use wgpu::{BufferUsages, MapMode, PollType};

use crate::WgpuBackend;
use crate::error::ignoring;
use crate::staging::{self, Mapping, State};

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
    free: Vec<Queries>,
}

/// Timestamps of a list, and their way to the CPU.
#[derive(Debug)]
struct Queries {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    copy: wgpu::Buffer,
}

/// A list that is being recorded.
#[derive(Debug)]
pub(crate) struct Frame {
    /// The passes, without their times.
    timings: Vec<Timing>,
    used: u32,
    queries: Queries,
}

/// A list whose timestamps are on their way.
#[derive(Debug)]
struct Finished {
    timings: Vec<Timing>,
    queries: Queries,
    state: State,
}

impl Queries {
    fn new(device: &wgpu::Device, count: u32) -> Self {
        let label = Some("hair.timestamps");
        let size = bytes(count);
        let usage = BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC;
        Self {
            set: device.create_query_set(&wgpu::QuerySetDescriptor { label, ty: wgpu::QueryType::Timestamp, count }),
            resolved: device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false }),
            copy: staging::create(device, size, BufferUsages::COPY_DST | BufferUsages::MAP_READ, false),
        }
    }
}

/// Bytes of so many timestamps.
fn bytes(count: u32) -> u64 {
    u64::from(count) * u64::from(wgpu::QUERY_SIZE)
}

impl WgpuBackend {
    /// Queries for every pass of `list`; `None` where there is nothing to time, or more than one query set holds.
    pub(crate) fn begin_timing(&mut self, list: &PassList) -> Result<Option<Frame>> {
        if self.timer.period.is_none() {
            return Ok(None);
        }
        let timings: Vec<Timing> = list
            .passes()
            .map(|(label, command)| {
                let bytes = accesses(command).into_iter().map(|(resource, _)| self.catalog.bytes(resource)).sum();
                Timing::new(label, command.scope().cloned(), bytes)
            })
            .collect();
        let count = 2 * timings.len() as u32;
        if !(1..=MAX_QUERIES).contains(&count) {
            return Ok(None);
        }
        self.timer.collect_discarded();
        let fits = self.timer.free.iter().position(|queries| queries.set.count() >= count);
        let queries = match fits {
            Some(index) => self.timer.free.swap_remove(index),
            None => self.guarded("hair.timestamps", bytes(count), |backend| {
                let count = count.next_power_of_two().clamp(64, MAX_QUERIES);
                Ok(Queries::new(&backend.device, count))
            })?,
        };
        Ok(Some(Frame { timings, used: 0, queries }))
    }

    /// The newest list whose times have arrived; older ones are forgotten.
    pub(crate) fn take_timings(&mut self) -> Vec<Timing> {
        if self.timer.pending.is_empty() || self.loss.poll(&self.device, PollType::Poll).is_err() {
            return Vec::new();
        }
        let Some(newest) = self.timer.pending.iter().rposition(|finished| finished.state.get() == Mapping::Done) else {
            return Vec::new();
        };
        let mut timings = Vec::new();
        let finished: Vec<_> = self.timer.pending.drain(..=newest).collect();
        for finished in finished {
            timings = self.timer.times(&self.device, finished);
        }
        timings
    }
}

impl Timer {
    pub(crate) fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let able = device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let period = able.then(|| queue.get_timestamp_period());
        Self { period, pending: VecDeque::new(), free: Vec::new() }
    }

    /// How many sets of queries there are.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.free.len() + self.pending.len()
    }

    /// After the last pass of a list.
    pub(crate) fn end(&mut self, device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, frame: Frame) {
        let Frame { timings, used, queries } = frame;
        encoder.resolve_query_set(&queries.set, 0..used, &queries.resolved, 0);
        encoder.copy_buffer_to_buffer(&queries.resolved, 0, &queries.copy, 0, bytes(used));
        let state = staging::map_on_submit(encoder, &queries.copy, MapMode::Read, bytes(used));
        self.pending.push_back(Finished { timings, queries, state });
        if self.pending.len() > MAX_PENDING
            && let Some(oldest) = self.pending.pop_front()
        {
            self.times(device, oldest);
        }
    }

    /// Takes the queries of encoders that were thrown away.
    fn collect_discarded(&mut self) {
        for finished in std::mem::take(&mut self.pending) {
            match finished.state.get() {
                Mapping::Discarded => self.give(finished.queries),
                Mapping::Failed => {}
                Mapping::Waiting | Mapping::Done => self.pending.push_back(finished),
            }
        }
    }

    fn give(&mut self, queries: Queries) {
        if self.free.len() < MAX_PENDING {
            self.free.push(queries);
        }
    }

    /// The times of a list, none if they have not arrived. Its queries can be used again.
    fn times(&mut self, device: &wgpu::Device, finished: Finished) -> Vec<Timing> {
        let Finished { mut timings, queries, state } = finished;
        let mapping = state.get();
        if mapping == Mapping::Discarded {
            self.give(queries);
            return Vec::new();
        }
        // Queries that an encoder may still use are dropped: wgpu keeps them for it.
        let (Mapping::Done, Some(period)) = (mapping, self.period) else { return Vec::new() };
        let read = ignoring(device, || {
            let mapped = queries.copy.get_mapped_range(..bytes(2 * timings.len() as u32));
            let ticks = mapped.map(|mapped| {
                mapped
                    .chunks_exact(8)
                    .map(|tick| tick.iter().rev().fold(0, |all, &byte| all << 8 | u64::from(byte)))
                    .collect()
            });
            queries.copy.unmap();
            ticks
        });
        let Ok::<Vec<u64>, _>(ticks) = read else { return Vec::new() };
        self.give(queries);
        for (timing, ends) in timings.iter_mut().zip(ticks.chunks_exact(2)) {
            let nanoseconds = |from: u64, to: u64| to.saturating_sub(from) as f64 * f64::from(period);
            timing.begin = nanoseconds(ticks[0], ends[0]);
            timing.nanoseconds = nanoseconds(ends[0], ends[1]);
        }
        timings
    }
}

impl Frame {
    fn next(&mut self) -> [Option<u32>; 2] {
        self.used += 2;
        [Some(self.used - 2), Some(self.used - 1)]
    }

    pub(crate) fn compute_writes(&mut self) -> wgpu::ComputePassTimestampWrites<'_> {
        let [beginning_of_pass_write_index, end_of_pass_write_index] = self.next();
        let query_set = &self.queries.set;
        wgpu::ComputePassTimestampWrites { query_set, beginning_of_pass_write_index, end_of_pass_write_index }
    }

    pub(crate) fn raster_writes(&mut self) -> wgpu::RenderPassTimestampWrites<'_> {
        let [beginning_of_pass_write_index, end_of_pass_write_index] = self.next();
        let query_set = &self.queries.set;
        wgpu::RenderPassTimestampWrites { query_set, beginning_of_pass_write_index, end_of_pass_write_index }
    }
}
