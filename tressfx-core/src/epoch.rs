//! Which lists may still name what was destroyed.
//!
//! A list belongs to the epoch in which its first command was written. To destroy a resource ends an epoch: lists of later
//! epochs must not name the resource, and it is freed once no list of that epoch or an earlier one exists any more.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// All epochs of the process. Numbers start at 1.
struct Epochs {
    now: u64,
    /// How many lists there are of each epoch; those without any are left out.
    lists: BTreeMap<u64, usize>,
}

static EPOCHS: Mutex<Epochs> = Mutex::new(Epochs { now: 1, lists: BTreeMap::new() });

fn epochs() -> MutexGuard<'static, Epochs> {
    EPOCHS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Held by a list that has commands.
#[derive(Debug)]
pub(crate) struct Epoch(u64);

impl Epoch {
    /// The epoch of now.
    pub(crate) fn now() -> Self {
        let mut epochs = epochs();
        let now = epochs.now;
        *epochs.lists.entry(now).or_default() += 1;
        Self(now)
    }

    pub(crate) fn number(&self) -> u64 {
        self.0
    }
}

impl Clone for Epoch {
    fn clone(&self) -> Self {
        *epochs().lists.entry(self.0).or_default() += 1;
        Self(self.0)
    }
}

impl Drop for Epoch {
    fn drop(&mut self) {
        let mut epochs = epochs();
        if let Some(count) = epochs.lists.get_mut(&self.0) {
            *count -= 1;
            if *count == 0 {
                epochs.lists.remove(&self.0);
            }
        }
    }
}

/// Ends the epoch if any list was begun in it, and says the number of the last one that has ended.
pub(crate) fn end() -> u64 {
    let mut epochs = epochs();
    if epochs.lists.contains_key(&epochs.now) {
        epochs.now += 1;
    }
    epochs.now - 1
}

/// Whether a list of this epoch or an earlier one exists.
pub(crate) fn is_listed(number: u64) -> bool {
    epochs().lists.first_key_value().is_some_and(|(&oldest, _)| oldest <= number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_epoch_is_listed_until_the_last_list_of_it_is_gone() {
        let first = Epoch::now();
        let ended = end();
        assert!(first.number() <= ended);
        let second = Epoch::now();
        assert!(second.number() > ended, "a list that was begun later is of a later epoch");
        let copy = first.clone();
        drop(first);
        assert!(is_listed(ended));
        let own = copy.number();
        drop(copy);
        drop(second);
        // Other tests of this process may hold lists, but none of this epoch.
        assert!(!epochs().lists.contains_key(&own) || epochs().lists[&own] > 0);
    }
}
