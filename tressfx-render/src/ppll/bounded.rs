//! Lists that do not hold all fragments: the nearest of each pixel have nodes, the others are added to the rest of their pixel.
//!
//! A first walk finds the nearest, so that it does not depend on the order in which fragments come which of them these are. The
//! rest consists of the sums of integers that the tail of a list is made of. So the picture is the same to the bit as that of lists
//! with room for all, as long as the nearest find room.

use tressfx_core::backend::Backend;
use tressfx_core::error::{Need, Result};
use tressfx_core::id::BufferId;
use tressfx_core::pass::PassList;
use tressfx_core::shader::Binding;

use super::{PpllDesc, fill, nearest};
use crate::output::Output;
use crate::region::Region;
use crate::resolved::{pixels, storage};
use crate::segments::{Segments, Walk};

/// Bytes of the sums and of the head of a pixel, and of the key of a depth where depth is written: see `rest.wgsl`.
fn rest_bytes(output: Output) -> u64 {
    if output.hair { 28 } else { 24 }
}

/// What such lists have beside a pool. Kernels are compiled when they are first needed, and kept; memory is freed when it is no
/// longer needed.
#[derive(Debug, Default)]
pub(crate) struct Bounded {
    kernels: Option<Kernels>,
    memory: Option<Memory>,
}

/// What was made and is not in use yet: if something else fails, it is forgotten.
#[derive(Debug)]
pub(crate) struct Prepared {
    kernels: Option<Kernels>,
    memory: Memory,
}

#[derive(Debug)]
struct Kernels {
    nearest: Segments,
    fill: Segments,
}

#[derive(Debug)]
struct Memory {
    /// `u32` each: the keys of the nearest fragments of a pixel.
    keys: BufferId,
    /// Six `u32` a pixel, or seven.
    rest: BufferId,
    /// Bytes of both.
    sizes: [u64; 2],
    /// Fragments of a pixel that there are keys for.
    asked: u32,
    output: Output,
}

impl Memory {
    fn new(backend: &mut dyn Backend, size: [u32; 2], asked: u32, output: Output) -> Result<Self> {
        let sizes = sizes(size, asked, output);
        let keys = storage(backend, "hair.render.nearest_keys", sizes[0])?;
        Ok(Self { keys, rest: storage(backend, "hair.render.rest", sizes[1])?, sizes, asked, output })
    }

    fn destroy(self, backend: &mut dyn Backend) {
        [self.keys, self.rest].into_iter().for_each(|buffer| backend.destroy(buffer.into()));
    }
}

fn sizes(size: [u32; 2], asked: u32, output: Output) -> [u64; 2] {
    [4 * u64::from(asked), rest_bytes(output)].map(|bytes| (bytes * pixels(size)).max(16))
}

/// Whether a device can have such lists for a picture of this size.
pub(crate) fn check(backend: &dyn Backend, size: [u32; 2], asked: u32, output: Output) -> Result<()> {
    let largest = sizes(size, asked, output).into_iter().max().unwrap_or(0);
    backend.caps().check("hair.render", &[Need::StorageBuffers(8), Need::StorageBindingBytes(largest)])
}

impl Bounded {
    /// Whether lists are bounded at present.
    pub(crate) fn is_on(&self) -> bool {
        self.memory.is_some()
    }

    /// Makes what it takes to keep as many fragments of a pixel as are asked for, and changes nothing yet.
    pub(crate) fn prepare(
        &self,
        backend: &mut dyn Backend,
        size: [u32; 2],
        desc: &PpllDesc,
        output: Output,
        walks_lists: bool,
    ) -> Result<Prepared> {
        check(backend, size, desc.asked(), output)?;
        let make = |backend: &mut dyn Backend| {
            let fill = fill::pass(backend, desc, [true, false], output)?.with_lists(backend, walks_lists)?;
            Ok(Kernels { nearest: nearest::pass(backend, output)?.with_lists(backend, walks_lists)?, fill })
        };
        let kernels = if self.kernels.is_none() { Some(make(backend)?) } else { None };
        Ok(Prepared { kernels, memory: Memory::new(backend, size, desc.asked(), output)? })
    }

    /// Makes what it takes to walk lists of segments, where there are kernels without it, and changes nothing yet.
    pub(crate) fn prepare_lists(&self, backend: &mut dyn Backend) -> Result<[Option<Walk>; 2]> {
        let Some(kernels) = &self.kernels else { return Ok([None, None]) };
        Ok([kernels.nearest.prepare_lists(backend)?, kernels.fill.prepare_lists(backend)?])
    }

    /// Walks lists with what was prepared.
    pub(crate) fn walk_lists(&mut self, [nearest, fill]: [Option<Walk>; 2]) {
        if let Some(kernels) = &mut self.kernels {
            kernels.nearest.walk_lists(nearest);
            kernels.fill.walk_lists(fill);
        }
    }

    /// Bounds lists with what was prepared.
    pub(crate) fn turn_on(&mut self, backend: &mut dyn Backend, prepared: Prepared) {
        if let Some(kernels) = prepared.kernels {
            self.kernels = Some(kernels);
        }
        if let Some(old) = self.memory.replace(prepared.memory) {
            old.destroy(backend);
        }
        self.forget_bindings();
    }

    /// Frees the memory.
    pub(crate) fn turn_off(&mut self, backend: &mut dyn Backend) {
        if let Some(memory) = self.memory.take() {
            memory.destroy(backend);
        }
        self.forget_bindings();
    }

    pub(crate) fn forget_bindings(&mut self) {
        if let Some(kernels) = &mut self.kernels {
            kernels.nearest.forget_bindings();
            kernels.fill.forget_bindings();
        }
    }

    pub(crate) fn begin_frame(&mut self) {
        if let Some(kernels) = &mut self.kernels {
            kernels.nearest.begin_frame();
            kernels.fill.begin_frame();
        }
    }

    /// How many fragments of a pixel can be kept; 0 where lists are not bounded.
    pub(crate) fn asked(&self) -> u32 {
        self.memory.as_ref().map_or(0, |memory| memory.asked)
    }

    pub(crate) fn bytes(&self) -> u64 {
        self.memory.as_ref().map_or(0, |memory| memory.sizes.iter().sum())
    }

    /// What `hair.render.resolve` reads.
    pub(crate) fn rest(&self) -> Option<(&'static str, Binding)> {
        self.memory.as_ref().map(|memory| ("rest", memory.rest.into()))
    }

    /// The passes, where lists are bounded: the walk that finds the `kept` nearest, and the one that stores. Empties the memory
    /// before.
    pub(crate) fn passes(&mut self) -> Option<Passes<'_>> {
        let (kernels, memory) = (self.kernels.as_mut()?, self.memory.as_ref()?);
        let keys = ("nearest_keys", memory.keys.into());
        let rest = ("rest", memory.rest.into());
        Some(Passes {
            nearest: &mut kernels.nearest,
            fill: &mut kernels.fill,
            keys,
            rest,
            buffers: [memory.keys, memory.rest],
            rest_bytes: rest_bytes(memory.output),
        })
    }
}

/// What the passes of a view need.
pub(crate) struct Passes<'a> {
    pub(crate) nearest: &'a mut Segments,
    pub(crate) fill: &'a mut Segments,
    pub(crate) keys: (&'static str, Binding),
    pub(crate) rest: (&'static str, Binding),
    buffers: [BufferId; 2],
    /// Of a pixel.
    rest_bytes: u64,
}

impl Passes<'_> {
    /// Empties the memory for a view.
    pub(crate) fn clear(&self, list: &mut PassList, region: &Region, kept: u32) {
        let [keys, rest] = self.buffers;
        region.clear(list, rest, self.rest_bytes);
        if kept > 0 {
            region.clear(list, keys, 4 * u64::from(kept));
        }
    }
}
