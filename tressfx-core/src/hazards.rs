//! Hazards: which earlier accesses each command of a list has to wait for. For APIs that need explicit barriers.
//!
//! For each resource [`Hazards`] keeps the last write and the kinds of access that have already waited for it. To keep the
//! last access only is not enough. Example: a compute pass writes, a compute pass reads, a raster pass reads. The raster
//! pass needs a wait of its own, since only compute has waited for the write.

use std::collections::HashMap;
use std::ops::BitOr;

use crate::id::Resource;
use crate::pass::{Command, Count, Draw, Groups, PassList};
use crate::shader::{Bindings, Shader, SlotKind};

/// Kinds of access, as a set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Access(u16);

impl Access {
    /// No access.
    pub const NONE: Self = Self(0);
    /// Read by a compute pass.
    pub const COMPUTE_READ: Self = Self(1);
    /// Written by a compute pass.
    pub const COMPUTE_WRITE: Self = Self(1 << 1);
    /// Read by the shaders of a raster pass.
    pub const RASTER_READ: Self = Self(1 << 2);
    /// Written by the shaders of a raster pass.
    pub const RASTER_WRITE: Self = Self(1 << 3);
    /// Read by a copy.
    pub const COPY_READ: Self = Self(1 << 4);
    /// Written by a copy, an upload or a clear.
    pub const COPY_WRITE: Self = Self(1 << 5);
    /// Drawn to, as a colour or depth target.
    pub const TARGET: Self = Self(1 << 6);
    /// Read as the number of groups of a compute pass, or of vertices and instances of a draw.
    pub const INDIRECT_READ: Self = Self(1 << 7);

    const WRITES: Self = Self(1 << 1 | 1 << 3 | 1 << 5 | 1 << 6);

    /// Whether anything in the set writes.
    pub fn writes(self) -> bool {
        self.0 & Self::WRITES.0 != 0
    }

    /// Whether all of `other` is in the set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl BitOr for Access {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// A command has to wait before it uses this resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wait {
    /// The resource.
    pub resource: Resource,
    /// The earlier accesses to wait for. Empty for a texture without contents, which only needs a layout.
    pub earlier: Access,
    /// The access that has to wait.
    pub later: Access,
}

/// The state of one resource.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct State {
    /// The last write, or the access that the layout was last changed for.
    written: Access,
    /// Reads since that write.
    read: Access,
    /// Kinds of access that have already waited for the write.
    waited: Access,
    /// The layout of a texture; `None` before its first use, and for buffers.
    layout: Option<Layout>,
}

/// The layout of a texture in memory. APIs with explicit barriers have layouts too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layout {
    /// As it is drawn to.
    Target,
    /// As shaders read it.
    Sampled,
    /// As compute passes write it, and read what they write.
    Storage,
    /// As it is copied from.
    CopySource,
    /// As it is copied to.
    CopyTarget,
}

impl Layout {
    /// The layout that an access to a texture needs.
    pub fn of(access: Access) -> Self {
        if access.contains(Access::TARGET) {
            Self::Target
        } else if access.contains(Access::COPY_WRITE) {
            Self::CopyTarget
        } else if access.contains(Access::COPY_READ) {
            Self::CopySource
        } else if access.writes() {
            Self::Storage
        } else {
            Self::Sampled
        }
    }
}

/// The state of all resources of a backend. It is given the commands in the order in which they are recorded, and lives as
/// long as the backend, so that hazards between two frames are found too.
#[derive(Clone, Debug, Default)]
pub struct Hazards {
    states: HashMap<Resource, State>,
    /// The resources that the present recording has used, with their states from before it.
    changed: HashMap<Resource, Option<State>>,
}

/// The states from before a recording, for [`Hazards::undo`] if the recording is thrown away.
#[derive(Clone, Debug, Default)]
pub struct Undo(HashMap<Resource, Option<State>>);

impl Hazards {
    /// What `command` has to wait for: at most one entry for each resource.
    pub fn waits_before(&mut self, command: &Command) -> Vec<Wait> {
        let mut waits = Vec::new();
        for (resource, access) in accesses(command) {
            waits.extend(self.note_access(resource, access));
        }
        waits
    }

    /// Forgets a destroyed resource.
    pub fn forget(&mut self, resource: Resource) {
        self.states.remove(&resource);
        self.changed.remove(&resource);
    }

    /// Ends a recording. Give the result to [`Hazards::undo`] if the recording never runs.
    pub fn end_recording(&mut self) -> Undo {
        Undo(std::mem::take(&mut self.changed))
    }

    /// Takes back a recording that will never run. The newest recording has to be taken back first, then the one before it.
    /// No recording may be unfinished at that time.
    pub fn undo(&mut self, Undo(states): Undo) {
        for (resource, state) in states {
            match state {
                Some(state) => drop(self.states.insert(resource, state)),
                None => drop(self.states.remove(&resource)),
            }
        }
    }

    /// The state of a resource for changing; keeps a copy for [`Undo`] at the first change of a recording.
    fn state(&mut self, resource: Resource) -> &mut State {
        self.changed.entry(resource).or_insert_with(|| self.states.get(&resource).copied());
        self.states.entry(resource).or_default()
    }

    /// Gives an imported resource back to its owner and forgets its state. The result are the accesses that the owner's next
    /// use has to wait for.
    pub fn release(&mut self, resource: Resource) -> Access {
        let state = std::mem::take(self.state(resource));
        self.states.remove(&resource);
        state.written | state.read
    }

    /// Notes an access, and gives what it has to wait for. [`Hazards::waits_before`] calls it for each access of a command. A
    /// backend calls it for accesses that are not in a command: zeros for a new resource, and what an engine did to a
    /// resource.
    pub fn note_access(&mut self, resource: Resource, access: Access) -> Option<Wait> {
        let state = self.state(resource);
        let layout = matches!(resource, Resource::Texture(_)).then(|| Layout::of(access));
        // A change of layout is a write, even if the access only reads. That access has waited for it.
        if access.writes() || state.layout != layout {
            let earlier = state.written | state.read;
            let (read, waited) = if access.writes() { (Access::NONE, Access::NONE) } else { (access, access) };
            let wait = !earlier.is_empty() || state.layout != layout;
            *state = State { written: access, read, waited, layout };
            return wait.then_some(Wait { resource, earlier, later: access });
        }
        let waited = state.written.is_empty() || state.waited.contains(access);
        let earlier = state.written;
        state.read = state.read | access;
        state.waited = state.waited | access;
        (!waited).then_some(Wait { resource, earlier, later: access })
    }
}

/// The resources that a command names, each once, with its accesses.
pub fn accesses(command: &Command) -> Vec<(Resource, Access)> {
    let mut found = Vec::new();
    match command {
        Command::Upload { dst, .. } | Command::Clear { dst, .. } => found.push(((*dst).into(), Access::COPY_WRITE)),
        Command::Copy { src, dst, .. } => {
            found.push(((*src).into(), Access::COPY_READ));
            found.push(((*dst).into(), Access::COPY_WRITE));
        }
        Command::CopyToTexture { src, dst, .. } => {
            found.push(((*src).into(), Access::COPY_READ));
            found.push(((*dst).into(), Access::COPY_WRITE));
        }
        Command::ReadBuffer { src, .. } => found.push(((*src).into(), Access::COPY_READ)),
        Command::ReadTexture { src, .. } => found.push(((*src).into(), Access::COPY_READ)),
        Command::Compute(pass) => {
            if let Groups::Indirect { buffer, .. } = pass.groups {
                found.push((buffer.into(), Access::INDIRECT_READ));
            }
            add_bindings(
                &mut found,
                &pass.kernel.shader,
                &pass.bindings,
                [Access::COMPUTE_READ, Access::COMPUTE_WRITE],
            );
        }
        Command::Raster(pass) => {
            for Draw { pipeline, bindings, count } in &pass.draws {
                add_bindings(&mut found, &pipeline.shader, bindings, [Access::RASTER_READ, Access::RASTER_WRITE]);
                if let Count::Indirect { buffer, .. } = count {
                    found.push(((*buffer).into(), Access::INDIRECT_READ));
                }
            }
            let depth = pass.depth.iter().map(|(texture, _)| texture);
            let targets = pass.colors.iter().map(|(texture, _)| texture).chain(depth);
            found.extend(targets.map(|&texture| (texture.into(), Access::TARGET)));
        }
    }
    merge(found)
}

fn add_bindings(found: &mut Vec<(Resource, Access)>, shader: &Shader, bindings: &Bindings, [read, write]: [Access; 2]) {
    for (slot, binding) in shader.slots.iter().zip(bindings.all()) {
        let access = match slot.kind {
            SlotKind::ReadWrite | SlotKind::ReadWriteTexture(_) => read | write,
            SlotKind::StorageTexture(_) => write,
            _ => read,
        };
        found.extend(binding.resource().map(|resource| (resource, access)));
    }
}

fn merge(found: Vec<(Resource, Access)>) -> Vec<(Resource, Access)> {
    let mut merged: Vec<(Resource, Access)> = Vec::with_capacity(found.len());
    for (resource, access) in found {
        match merged.iter_mut().find(|(other, _)| *other == resource) {
            Some(entry) => entry.1 = entry.1 | access,
            None => merged.push((resource, access)),
        }
    }
    merged
}

/// The hazards of a whole list, one entry a command: for tests and for printing.
pub fn of_list(list: &PassList) -> Vec<Vec<Wait>> {
    let mut hazards = Hazards::default();
    list.commands().iter().map(|command| hazards.waits_before(command)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::id::Slots;

    fn ids() -> [Resource; 2] {
        let mut slots = Slots::default();
        [slots.insert(()), slots.insert(())].map(|slot| Resource::Buffer(slot.into()))
    }

    fn wait(resource: Resource, earlier: Access, later: Access) -> Option<Wait> {
        Some(Wait { resource, earlier, later })
    }

    #[test]
    fn written_in_compute_read_in_compute_read_in_graphics_waits_twice() {
        let [a, _] = ids();
        let mut hazards = Hazards::default();
        assert_eq!(hazards.note_access(a, Access::COMPUTE_WRITE), None);
        assert_eq!(hazards.note_access(a, Access::COMPUTE_READ), wait(a, Access::COMPUTE_WRITE, Access::COMPUTE_READ));
        assert_eq!(hazards.note_access(a, Access::COMPUTE_READ), None, "it has waited already");
        assert_eq!(hazards.note_access(a, Access::RASTER_READ), wait(a, Access::COMPUTE_WRITE, Access::RASTER_READ));
        assert_eq!(hazards.note_access(a, Access::RASTER_READ), None);
    }

    #[test]
    fn a_write_waits_for_the_readers_and_the_last_writer() {
        let [a, b] = ids();
        let mut hazards = Hazards::default();
        assert_eq!(hazards.note_access(a, Access::COPY_WRITE), None);
        hazards.note_access(a, Access::COMPUTE_READ);
        hazards.note_access(a, Access::RASTER_READ);
        let readers = Access::COPY_WRITE | Access::COMPUTE_READ | Access::RASTER_READ;
        assert_eq!(hazards.note_access(a, Access::COPY_WRITE), wait(a, readers, Access::COPY_WRITE));
        assert_eq!(hazards.note_access(a, Access::COPY_WRITE), wait(a, Access::COPY_WRITE, Access::COPY_WRITE));
        assert_eq!(hazards.note_access(b, Access::COMPUTE_READ), None, "other resources are not waited for");
    }

    #[test]
    fn reads_alone_never_wait() {
        let [a, _] = ids();
        let mut hazards = Hazards::default();
        for access in [Access::COMPUTE_READ, Access::RASTER_READ, Access::COPY_READ, Access::COMPUTE_READ] {
            assert_eq!(hazards.note_access(a, access), None);
        }
    }

    #[test]
    fn a_texture_waits_for_every_change_of_its_layout() {
        let mut slots = Slots::default();
        let a = Resource::Texture(slots.insert(()).into());
        let mut hazards = Hazards::default();
        assert_eq!(
            hazards.note_access(a, Access::TARGET),
            wait(a, Access::NONE, Access::TARGET),
            "it has no layout yet"
        );
        assert_eq!(hazards.note_access(a, Access::RASTER_READ), wait(a, Access::TARGET, Access::RASTER_READ));
        assert_eq!(hazards.note_access(a, Access::RASTER_READ), None);
        assert_eq!(hazards.note_access(a, Access::COMPUTE_READ), wait(a, Access::RASTER_READ, Access::COMPUTE_READ));
        let reads = Access::RASTER_READ | Access::COMPUTE_READ;
        assert_eq!(
            hazards.note_access(a, Access::COPY_READ),
            wait(a, reads, Access::COPY_READ),
            "copied is another layout"
        );
        assert_eq!(hazards.note_access(a, Access::COPY_READ), None);
    }

    #[test]
    fn what_is_given_back_begins_anew() {
        let [a, _] = ids();
        let mut hazards = Hazards::default();
        hazards.note_access(a, Access::COMPUTE_WRITE);
        hazards.note_access(a, Access::RASTER_READ);
        assert_eq!(hazards.release(a), Access::COMPUTE_WRITE | Access::RASTER_READ);
        assert_eq!(hazards.release(a), Access::NONE);
        assert_eq!(hazards.note_access(a, Access::RASTER_READ), None);
    }

    #[test]
    fn a_recording_that_is_taken_back_leaves_everything_as_it_was() {
        let [a, b] = ids();
        let mut hazards = Hazards::default();
        hazards.note_access(a, Access::COMPUTE_WRITE);
        let first = hazards.end_recording();
        hazards.note_access(a, Access::COMPUTE_READ);
        hazards.note_access(a, Access::COPY_WRITE);
        hazards.note_access(b, Access::COPY_WRITE);
        let second = hazards.end_recording();
        hazards.undo(second);
        assert_eq!(hazards.note_access(a, Access::COMPUTE_READ), wait(a, Access::COMPUTE_WRITE, Access::COMPUTE_READ));
        assert_eq!(hazards.note_access(b, Access::COMPUTE_READ), None);
        let third = hazards.end_recording();
        hazards.undo(third);
        hazards.undo(first);
        assert!(hazards.states.is_empty());
    }

    #[test]
    fn a_write_in_place_waits_for_its_own_predecessor() {
        let [a, _] = ids();
        let mut hazards = Hazards::default();
        let update = Access::COMPUTE_READ | Access::COMPUTE_WRITE;
        assert_eq!(hazards.note_access(a, update), None);
        assert_eq!(hazards.note_access(a, update), wait(a, update, update));
        hazards.forget(a);
        assert_eq!(hazards.note_access(a, update), None);
    }
}
