//! Ids of resources: small, `Copy`, and never silently reused.

use std::hash::Hash;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::epoch;

/// A place in a [`Slots`] arena and the generation that lives there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Slot {
    arena: u32,
    index: u32,
    generation: u32,
}

macro_rules! id {
    ($(#[$doc:meta] $name:ident)*) => {$(
        #[$doc]
        #[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub Slot);

        impl From<Slot> for $name {
            fn from(slot: Slot) -> Self {
                Self(slot)
            }
        }

        impl std::fmt::Debug for $name {
            fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
                write!(out, "{}({}.{})", stringify!($name), self.0.index, self.0.generation)
            }
        }
    )*};
}

id! {
    /// A buffer of a backend.
    BufferId
    /// A texture of a backend.
    TextureId
    /// A compiled compute or raster pipeline of a backend.
    PipelineId
}

/// Anything that holds memory of a backend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Resource {
    /// A storage or uniform buffer.
    Buffer(BufferId),
    /// A texture.
    Texture(TextureId),
}

impl From<BufferId> for Resource {
    fn from(id: BufferId) -> Self {
        Self::Buffer(id)
    }
}

impl From<TextureId> for Resource {
    fn from(id: TextureId) -> Self {
        Self::Texture(id)
    }
}

#[derive(Debug)]
struct Place<T> {
    generation: u32,
    value: Option<T>,
    /// The last epoch whose lists may name the value, once it was retired.
    retired: Option<u64>,
}

/// An arena that a backend keeps its resources in.
///
/// An id that outlives its resource, or that is of another arena, finds nothing: not what was put in the same place later.
#[derive(Debug)]
pub struct Slots<T> {
    arena: u32,
    places: Vec<Place<T>>,
    free: Vec<u32>,
    /// Places whose values were retired and not swept yet.
    retired: Vec<u32>,
}

impl<T> Default for Slots<T> {
    fn default() -> Self {
        static ARENAS: AtomicU32 = AtomicU32::new(0);
        let arena = ARENAS.fetch_add(1, Ordering::Relaxed);
        Self { arena, places: Vec::new(), free: Vec::new(), retired: Vec::new() }
    }
}

impl<T> Slots<T> {
    /// Stores `value` and names its place.
    pub fn insert(&mut self, value: T) -> Slot {
        let index = self.free.pop().unwrap_or_else(|| {
            self.places.push(Place { generation: 0, value: None, retired: None });
            (self.places.len() - 1) as u32
        });
        let place = &mut self.places[index as usize];
        (place.value, place.retired) = (Some(value), None);
        Slot { arena: self.arena, index, generation: place.generation }
    }

    fn place(&self, slot: Slot) -> Option<&Place<T>> {
        let place = self.places.get(slot.index as usize)?;
        (slot.arena == self.arena && place.generation == slot.generation).then_some(place)
    }

    /// The value, also if it was retired and not swept yet; `None` if the id is stale or of another arena.
    pub fn get(&self, slot: Slot) -> Option<&T> {
        self.place(slot)?.value.as_ref()
    }

    /// As [`Slots::get`], to be changed.
    pub fn get_mut(&mut self, slot: Slot) -> Option<&mut T> {
        self.place(slot)?;
        self.places[slot.index as usize].value.as_mut()
    }

    /// The value, if a list of that epoch may name it.
    pub(crate) fn get_in(&self, slot: Slot, epoch: u64) -> Option<&T> {
        let place = self.place(slot)?;
        place.value.as_ref().filter(|_| place.retired.is_none_or(|last| epoch <= last))
    }

    /// Marks the value as not to be named by lists that are begun from now on. `None` if it was marked before, or there is
    /// none.
    pub fn retire(&mut self, slot: Slot) -> Option<&T> {
        if self.place(slot)?.retired.is_some() {
            return None;
        }
        let place = &mut self.places[slot.index as usize];
        place.value.as_ref()?;
        place.retired = Some(epoch::end());
        self.retired.push(slot.index);
        place.value.as_ref()
    }

    /// Takes out the retired values that no list can name any more.
    pub fn sweep(&mut self) -> Vec<(Slot, T)> {
        let over = |place: &Place<T>| place.retired.is_some_and(|last| !epoch::is_listed(last));
        let gone: Vec<u32> = self.retired.extract_if(.., |&mut index| over(&self.places[index as usize])).collect();
        gone.into_iter().filter_map(|index| self.take(index)).collect()
    }

    /// Takes all values out, in no particular order; all ids are stale from now on.
    pub fn drain(&mut self) -> impl Iterator<Item = T> {
        self.retired.clear();
        let all = 0..self.places.len() as u32;
        all.filter_map(|index| self.take(index).map(|(_, value)| value))
    }

    fn take(&mut self, index: u32) -> Option<(Slot, T)> {
        let place = &mut self.places[index as usize];
        let value = place.value.take()?;
        let slot = Slot { arena: self.arena, index, generation: place.generation };
        // A place whose generations are used up is not used again.
        if let Some(next) = place.generation.checked_add(1) {
            place.generation = next;
            self.free.push(index);
        }
        Some((slot, value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::epoch::Epoch;

    #[test]
    fn a_reused_place_has_a_new_generation() {
        let mut slots = Slots::default();
        let first = slots.insert('a');
        assert_eq!(slots.retire(first), Some(&'a'));
        assert_eq!(slots.retire(first), None, "once");
        while slots.get(first).is_some() {
            // Lists of other tests may be of an older epoch.
            slots.sweep();
        }
        let second = slots.insert('b');
        assert_ne!(first, second);
        assert_eq!((slots.get(first), slots.get(second)), (None, Some(&'b')));
        assert_eq!(slots.retire(first), None, "a stale id must not retire the newer value");
        assert_eq!(slots.drain().collect::<Vec<_>>(), ['b']);
        assert_eq!(slots.get(second), None);
    }

    #[test]
    fn an_id_of_another_arena_finds_nothing() {
        let (mut one, mut other) = (Slots::default(), Slots::default());
        let (mine, theirs) = (one.insert(1), other.insert(2));
        assert_eq!((one.get(mine), one.get(theirs)), (Some(&1), None));
        assert_eq!(one.retire(theirs), None);
        assert_eq!(one.get_mut(theirs), None);
    }

    #[test]
    fn a_retired_value_lives_on_for_the_lists_that_were_begun_before() {
        let mut slots = Slots::default();
        let slot = slots.insert('a');
        let before = Epoch::now();
        slots.retire(slot);
        let after = Epoch::now();
        assert_eq!(slots.sweep(), []);
        assert_eq!(slots.get_in(slot, before.number()), Some(&'a'));
        assert_eq!(slots.get_in(slot, after.number()), None);
    }
}
