//! Bindings that are made once, and kernels with theirs.

use std::collections::HashMap;
use std::hash::Hash;

use tressfx_core::error::Result;
use tressfx_core::pass::{Groups, PassList};
use tressfx_core::shader::{Binding, Bindings, Kernel};

/// Frames for which bindings wait for another use: targets take turns, sections come and go.
const UNUSED_FRAMES: u64 = 32;

/// Bindings of one kernel, by what differs between them.
#[derive(Debug)]
pub(crate) struct Bound<K> {
    frame: u64,
    made: HashMap<K, (Bindings, u64)>,
}

impl<K: Eq + Hash> Bound<K> {
    pub(crate) fn new() -> Self {
        Self { frame: 0, made: HashMap::new() }
    }

    /// Forgets what was not used for a while.
    pub(crate) fn begin_frame(&mut self) {
        self.frame += 1;
        let frame = self.frame;
        self.made.retain(|_, (_, used)| frame - *used <= UNUSED_FRAMES);
    }

    /// The bindings of a key, made at its first use.
    pub(crate) fn get(&mut self, key: K, make: impl FnOnce() -> Result<Bindings>) -> Result<Bindings> {
        if let Some((bindings, used)) = self.made.get_mut(&key) {
            *used = self.frame;
            return Ok(bindings.clone());
        }
        let bindings = make()?;
        self.made.insert(key, (bindings.clone(), self.frame));
        Ok(bindings)
    }

    /// Forgets all: what they name has been replaced.
    pub(crate) fn clear(&mut self) {
        self.made.clear();
    }
}

/// A kernel and its bindings, by what differs between them.
#[derive(Debug)]
pub(crate) struct Pass<K> {
    pub(crate) kernel: Kernel,
    bound: Bound<K>,
}

impl<K: Eq + Hash> Pass<K> {
    pub(crate) fn new(kernel: Kernel) -> Self {
        Self { kernel, bound: Bound::new() }
    }

    pub(crate) fn begin_frame(&mut self) {
        self.bound.begin_frame();
    }

    pub(crate) fn forget_bindings(&mut self) {
        self.bound.clear();
    }

    /// Runs so many groups.
    pub(crate) fn record(
        &mut self,
        list: &mut PassList,
        key: K,
        groups: Groups,
        resources: &[(&str, Binding)],
    ) -> Result<()> {
        let bindings = self.bound.get(key, || self.kernel.bind(resources))?;
        match groups {
            Groups::Grid(grid) => list.compute(&self.kernel, &bindings, grid),
            Groups::Indirect { buffer, offset } => list.compute_indirect(&self.kernel, &bindings, buffer, offset),
        }
        Ok(())
    }
}
