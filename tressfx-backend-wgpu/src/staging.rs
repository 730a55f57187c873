//! Buffers that the CPU sees, used again and again.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use wgpu::{BufferUsages, MapMode};

/// Buffers that wait for their next use: so many, of at most so many bytes.
const KEPT: usize = 16;
const KEPT_BYTES: u64 = 4 << 20;

/// What has become of a buffer that was to be mapped once its encoder has run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mapping {
    /// Nothing yet.
    Waiting,
    /// It is mapped.
    Done,
    /// The device refused.
    Failed,
    /// The encoder was thrown away: the buffer was not used.
    Discarded,
}

impl Mapping {
    const ALL: [Self; 4] = [Self::Waiting, Self::Done, Self::Failed, Self::Discarded];
}

/// Tells of a mapping.
#[derive(Debug)]
pub(crate) struct State(Arc<AtomicU8>);

impl State {
    pub(crate) fn get(&self) -> Mapping {
        Mapping::ALL[usize::from(self.0.load(Ordering::Acquire))]
    }
}

/// Held by the callback of a mapping. wgpu drops the callbacks of encoders that are thrown away.
struct Promise(Arc<AtomicU8>);

impl Promise {
    fn keep(&self, mapping: Mapping) {
        let waiting = Mapping::Waiting as u8;
        let _ = self.0.compare_exchange(waiting, mapping as u8, Ordering::AcqRel, Ordering::Acquire);
    }
}

impl Drop for Promise {
    fn drop(&mut self) {
        self.keep(Mapping::Discarded);
    }
}

fn promise() -> (State, impl FnOnce(Result<(), wgpu::BufferAsyncError>) + Send + 'static) {
    let state = Arc::new(AtomicU8::new(Mapping::Waiting as u8));
    let promise = Promise(state.clone());
    (State(state), move |result| promise.keep(if result.is_ok() { Mapping::Done } else { Mapping::Failed }))
}

/// Has the first bytes of a buffer mapped once `encoder` was submitted and has run.
pub(crate) fn map_on_submit(encoder: &wgpu::CommandEncoder, buffer: &wgpu::Buffer, mode: MapMode, bytes: u64) -> State {
    let (state, callback) = promise();
    encoder.map_buffer_on_submit(buffer, mode, ..bytes, callback);
    state
}

/// Has a whole buffer mapped that nothing on the GPU uses.
pub(crate) fn map_now(buffer: &wgpu::Buffer, mode: MapMode) -> State {
    let (state, callback) = promise();
    buffer.map_async(mode, .., callback);
    state
}

/// Makes a buffer for at least so many bytes.
pub(crate) fn create(device: &wgpu::Device, bytes: u64, usage: BufferUsages, mapped: bool) -> wgpu::Buffer {
    // Powers of two are used again more often. Large buffers are not kept.
    let size = if bytes <= KEPT_BYTES { bytes.next_power_of_two().max(256) } else { bytes };
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(if usage.contains(BufferUsages::MAP_WRITE) { "hair.uploads" } else { "hair.read_back" }),
        size,
        usage,
        mapped_at_creation: mapped,
    })
}

/// Buffers that are used by nothing.
#[derive(Debug, Default)]
pub(crate) struct Pool(Vec<wgpu::Buffer>);

impl Pool {
    /// The smallest that holds so many bytes.
    pub(crate) fn take(&mut self, bytes: u64) -> Option<wgpu::Buffer> {
        let fits = self.0.iter().enumerate().filter(|(_, buffer)| buffer.size() >= bytes);
        let best = fits.min_by_key(|(_, buffer)| buffer.size())?.0;
        Some(self.0.swap_remove(best))
    }

    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.0.len()
    }

    /// Keeps a buffer for its next use, unless it is large or there are enough.
    pub(crate) fn give(&mut self, buffer: wgpu::Buffer) {
        if buffer.size() <= KEPT_BYTES && self.0.len() < KEPT {
            self.0.push(buffer);
        }
    }
}
