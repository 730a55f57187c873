//! What each pass costs: timestamps at its two ends, and shader invocations.

use ash::vk;
use tressfx_core::backend::Timing;
use tressfx_core::error::Result;

use crate::device::Gpu;
use crate::frames::Recording;

/// Stages whose invocations are counted, in the order in which Vulkan writes them.
const COUNTED: vk::QueryPipelineStatisticFlags = vk::QueryPipelineStatisticFlags::from_raw(
    vk::QueryPipelineStatisticFlags::VERTEX_SHADER_INVOCATIONS.as_raw()
        | vk::QueryPipelineStatisticFlags::FRAGMENT_SHADER_INVOCATIONS.as_raw()
        | vk::QueryPipelineStatisticFlags::COMPUTE_SHADER_INVOCATIONS.as_raw(),
);

/// Reads the queries of finished recordings.
#[derive(Debug)]
pub(crate) struct Timer {
    /// Nanoseconds of one tick; `None` where the device cannot time.
    period: Option<f64>,
    /// The newest finished list that has passes.
    newest: Vec<Timing>,
}

/// The queries of one recording.
#[derive(Debug, Default)]
pub(crate) struct Queries {
    timestamps: vk::QueryPool,
    statistics: vk::QueryPool,
    /// Passes that fit in.
    capacity: u32,
    /// The passes so far, without their times.
    passes: Vec<Timing>,
}

impl Timer {
    pub(crate) fn new(gpu: &Gpu, able: bool) -> Self {
        let period = able.then(|| f64::from(gpu.properties.limits.timestamp_period));
        Self { period, newest: Vec::new() }
    }

    /// Makes room for the queries of so many passes.
    pub(crate) fn prepare(&self, gpu: &Gpu, queries: &mut Queries, passes: usize) -> Result<()> {
        queries.passes.clear();
        if self.period.is_none() || passes == 0 {
            return Ok(());
        }
        if queries.capacity < passes as u32 {
            queries.grow(gpu, (passes as u32).next_power_of_two())?;
        }
        Ok(())
    }

    /// Before the first pass.
    pub(crate) fn begin(&self, gpu: &Gpu, commands: vk::CommandBuffer, queries: &Queries, passes: usize) {
        if self.period.is_none() || passes == 0 {
            return;
        }
        // SAFETY: the command buffer is being recorded, outside of a render pass; the queries are not in use.
        unsafe {
            gpu.device.cmd_reset_query_pool(commands, queries.timestamps, 0, 2 * queries.capacity);
            if gpu.enabled.statistics {
                gpu.device.cmd_reset_query_pool(commands, queries.statistics, 0, queries.capacity);
            }
        }
    }

    /// Before the first command of a pass.
    pub(crate) fn begin_pass(&self, gpu: &Gpu, commands: vk::CommandBuffer, queries: &mut Queries, pass: Timing) {
        if self.period.is_none() {
            return;
        }
        let index = queries.passes.len() as u32;
        queries.passes.push(pass);
        let (stage, pool) = (vk::PipelineStageFlags2::ALL_COMMANDS, queries.timestamps);
        // Counting is outside of the time: it takes an H200 ten microseconds a pass.
        // SAFETY: as above, and there is room for this pass.
        unsafe {
            if gpu.enabled.statistics {
                let flags = vk::QueryControlFlags::empty();
                gpu.device.cmd_begin_query(commands, queries.statistics, index, flags);
            }
            gpu.device.cmd_write_timestamp2(commands, stage, pool, 2 * index);
        }
    }

    /// After the last command of a pass.
    pub(crate) fn end_pass(&self, gpu: &Gpu, commands: vk::CommandBuffer, queries: &Queries) {
        let Some(index) = queries.passes.len().checked_sub(1) else { return };
        let index = index as u32;
        let (stage, pool) = (vk::PipelineStageFlags2::ALL_COMMANDS, queries.timestamps);
        // SAFETY: as above.
        unsafe {
            gpu.device.cmd_write_timestamp2(commands, stage, pool, 2 * index + 1);
            if gpu.enabled.statistics {
                gpu.device.cmd_end_query(commands, queries.statistics, index);
            }
        }
    }

    /// Reads the queries of a recording that has run. One without passes leaves what is known of the one before it.
    pub(crate) fn finish(&mut self, gpu: &Gpu, recording: &mut Recording) {
        let Some(period) = self.period else { return };
        let mut passes = std::mem::take(&mut recording.queries.passes);
        if passes.is_empty() {
            return;
        }
        let Some(ticks) = results::<2>(gpu, recording.queries.timestamps, 2, passes.len()) else { return };
        let counts = gpu.enabled.statistics.then(|| results::<3>(gpu, recording.queries.statistics, 1, passes.len()));
        let first = ticks.first().map_or(0, |ends| ends[0]);
        for (index, (pass, ends)) in passes.iter_mut().zip(&ticks).enumerate() {
            pass.begin = ends[0].saturating_sub(first) as f64 * period;
            pass.nanoseconds = ends[1].saturating_sub(ends[0]) as f64 * period;
            pass.invocations = counts.iter().flatten().next().map(|counts| counts[index].iter().sum());
        }
        self.newest = passes;
    }

    pub(crate) fn take(&mut self) -> Vec<Timing> {
        std::mem::take(&mut self.newest)
    }
}

impl Queries {
    fn grow(&mut self, gpu: &Gpu, capacity: u32) -> Result<()> {
        let times = vk::QueryPoolCreateInfo::default().query_type(vk::QueryType::TIMESTAMP).query_count(2 * capacity);
        // SAFETY: the device is alive.
        let timestamps = gpu.create("hair.timestamps", |device| unsafe { device.create_query_pool(&times, None) })?;
        let mut statistics = vk::QueryPool::null();
        if gpu.enabled.statistics {
            let counts = vk::QueryPoolCreateInfo::default()
                .query_type(vk::QueryType::PIPELINE_STATISTICS)
                .query_count(capacity)
                .pipeline_statistics(COUNTED);
            // SAFETY: as above, and the feature is enabled.
            let made = gpu.create("hair.statistics", |device| unsafe { device.create_query_pool(&counts, None) });
            statistics = made.inspect_err(|_| {
                // SAFETY: nothing uses it.
                unsafe { gpu.device.destroy_query_pool(timestamps, None) };
            })?;
        }
        self.destroy(gpu);
        (self.timestamps, self.statistics, self.capacity) = (timestamps, statistics, capacity);
        Ok(())
    }

    pub(crate) fn destroy(&self, gpu: &Gpu) {
        // SAFETY: the GPU has finished with them; null is nothing to destroy.
        unsafe {
            gpu.device.destroy_query_pool(self.timestamps, None);
            gpu.device.destroy_query_pool(self.statistics, None);
        }
    }
}

/// `N` numbers a pass, from `queries` queries each; `None` if they are not there.
fn results<const N: usize>(gpu: &Gpu, pool: vk::QueryPool, queries: usize, passes: usize) -> Option<Vec<[u64; N]>> {
    let mut values = vec![[0u64; N]; passes];
    let flags = vk::QueryResultFlags::TYPE_64;
    let got = if queries == N {
        // One number a query.
        // SAFETY: the pool holds so many queries of one number.
        unsafe { gpu.device.get_query_pool_results(pool, 0, values.as_flattened_mut(), flags) }
    } else {
        // SAFETY: the pool holds so many queries of `N` numbers.
        unsafe { gpu.device.get_query_pool_results(pool, 0, &mut values, flags) }
    };
    got.is_ok().then_some(values)
}
