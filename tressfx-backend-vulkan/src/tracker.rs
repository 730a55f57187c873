//! What the next command has to wait for.

use ash::vk;
use tressfx_core::hazards::{Access, Hazards};
use tressfx_core::id::Resource;

use crate::Resources;
use crate::barrier::Barrier;
use crate::device::Gpu;
use crate::resource::Ownership;
use crate::tables::scope;

/// The state of all resources, as of the newest recording.
#[derive(Debug, Default)]
pub(crate) struct Tracker {
    pub(crate) hazards: Hazards,
    /// Made, and not filled with zeros yet.
    pub(crate) not_zeroed: Vec<Resource>,
    pub(crate) barrier: Barrier,
    /// Imported resources that the list under way has touched.
    borrowed: Vec<Resource>,
    /// Barriers that were recorded.
    pub(crate) barriers: u64,
}

impl Tracker {
    /// Adds what has to be waited for before `resource` is used so.
    pub(crate) fn wait_for(&mut self, resources: &Resources, resource: Resource, access: Access) {
        let wait = self.hazards.note_access(resource, access);
        let first = !self.borrowed.contains(&resource);
        match resource {
            Resource::Buffer(id) => match &resources.buffer(id).owner {
                Ownership::Engine { initial_use, .. } if first => {
                    self.borrowed.push(resource);
                    self.barrier.buffer((initial_use.stage, initial_use.access), scope(access, None));
                }
                _ => wait.iter().for_each(|wait| {
                    self.barrier.buffer(scope(wait.earlier, None), scope(wait.later, None));
                }),
            },
            Resource::Texture(id) => {
                let texture = resources.texture(id);
                match &texture.owner {
                    Ownership::Engine { initial_use, .. } if first => {
                        self.borrowed.push(resource);
                        self.barrier.acquire(texture, initial_use, access);
                    }
                    _ => wait.iter().for_each(|wait| self.barrier.texture(texture, wait.earlier, wait.later)),
                }
            }
        }
    }

    /// Gives what was borrowed back, in the use that was promised.
    pub(crate) fn give_back(&mut self, gpu: &Gpu, resources: &Resources, commands: vk::CommandBuffer) {
        for resource in std::mem::take(&mut self.borrowed) {
            let earlier = self.hazards.release(resource);
            match resource {
                Resource::Buffer(id) => {
                    if let Ownership::Engine { final_use, .. } = &resources.buffer(id).owner {
                        self.barrier.buffer(scope(earlier, None), (final_use.stage, final_use.access));
                    }
                }
                Resource::Texture(id) => {
                    let texture = resources.texture(id);
                    if let Ownership::Engine { final_use, .. } = &texture.owner {
                        self.barrier.release(texture, earlier, final_use);
                    }
                }
            }
        }
        self.write(gpu, commands);
    }

    /// Writes what was added since the last barrier.
    pub(crate) fn write(&mut self, gpu: &Gpu, commands: vk::CommandBuffer) {
        self.barriers += u64::from(self.barrier.record(gpu, commands));
    }
}
