//! Ids of resources: small, `Copy`, and never silently reused.

use std::hash::Hash;

/// A place in a [`Slots`] arena and the generation that lives there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Slot {
    index: u32,
    generation: u32,
}

macro_rules! id {
    ($(#[$doc:meta] $name:ident)*) => {$(
        #[$doc]
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub Slot);

        impl From<Slot> for $name {
            fn from(slot: Slot) -> Self {
                Self(slot)
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

/// Anything that a shader can be given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Resource {
    /// A storage or uniform buffer.
    Buffer(BufferId),
    /// A sampled texture.
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

/// An arena that a backend keeps its resources in.
///
/// An id that outlives its resource is noticed: its generation no longer matches, and the access panics with the name of
/// the operation instead of touching whatever was put in the same place later.
#[derive(Debug)]
pub struct Slots<T> {
    entries: Vec<(u32, Option<T>)>,
    free: Vec<u32>,
}

impl<T> Default for Slots<T> {
    fn default() -> Self {
        Self { entries: Vec::new(), free: Vec::new() }
    }
}

impl<T> Slots<T> {
    /// Stores `value` and names its place.
    pub fn insert(&mut self, value: T) -> Slot {
        if let Some(index) = self.free.pop() {
            let entry = &mut self.entries[index as usize];
            entry.1 = Some(value);
            return Slot { index, generation: entry.0 };
        }
        self.entries.push((0, Some(value)));
        Slot { index: (self.entries.len() - 1) as u32, generation: 0 }
    }

    /// Takes the value out; the id is stale from now on. `None` if it was stale before.
    pub fn remove(&mut self, slot: Slot) -> Option<T> {
        let entry = self.entries.get_mut(slot.index as usize)?;
        if entry.0 != slot.generation {
            return None;
        }
        let value = entry.1.take()?;
        entry.0 += 1;
        self.free.push(slot.index);
        Some(value)
    }

    /// The value, or `None` if the id is stale.
    pub fn get(&self, slot: Slot) -> Option<&T> {
        self.entries.get(slot.index as usize).filter(|entry| entry.0 == slot.generation)?.1.as_ref()
    }

    /// The value, to be changed, or `None` if the id is stale.
    pub fn get_mut(&mut self, slot: Slot) -> Option<&mut T> {
        self.entries.get_mut(slot.index as usize).filter(|entry| entry.0 == slot.generation)?.1.as_mut()
    }

    /// The value.
    ///
    /// # Panics
    /// If the id is stale: a mistake of the program, not of its input.
    pub fn expect(&self, slot: Slot, what: &str) -> &T {
        self.get(slot).unwrap_or_else(|| panic!("{what}: the id {slot:?} is stale, its resource was destroyed"))
    }

    /// Takes all values out, in no particular order; all ids are stale from now on.
    pub fn drain(&mut self) -> impl Iterator<Item = T> {
        let live = self.entries.iter().enumerate().filter(|(_, entry)| entry.1.is_some());
        let slots: Vec<_> = live.map(|(index, entry)| Slot { index: index as u32, generation: entry.0 }).collect();
        slots.into_iter().filter_map(|slot| self.remove(slot))
    }

    /// All values, in no particular order.
    pub fn values(&self) -> impl Iterator<Item = &T> {
        self.entries.iter().filter_map(|entry| entry.1.as_ref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reused_place_has_a_new_generation() {
        let mut slots = Slots::default();
        let first = slots.insert('a');
        assert_eq!(slots.remove(first), Some('a'));
        let second = slots.insert('b');
        assert_ne!(first, second);
        assert_eq!(slots.get(first), None);
        assert_eq!(slots.get(second), Some(&'b'));
        assert_eq!(slots.remove(first), None, "a stale id must not remove the newer value");
        assert_eq!(slots.values().count(), 1);
    }

    #[test]
    #[should_panic(expected = "upload: the id")]
    fn a_stale_id_panics_with_the_name_of_the_operation() {
        let mut slots = Slots::default();
        let slot = slots.insert(1);
        slots.remove(slot);
        slots.expect(slot, "upload");
    }
}
