//! A simulation that sleeps while nothing happens: see [`crate::sleep`].

use tressfx_core::backend::Backend;
use tressfx_core::pass::PassList;

use super::HairSim;
use crate::buffers::storage;
use crate::error::SimError;
use crate::input::StepInput;
use crate::sleep::{Measure, MotionTicket, Sleep, SleepParams};

impl HairSim {
    /// Lets the groom sleep from now on: once it has come to rest, and as long as the head stands still, colliders, roots and parameters stay the
    /// same and no wind blows, [`HairSim::step`] records nothing. What changes wakes it in that same frame, and time has gone on. Its strands stay where they
    /// were measured to be at rest, so that it moves on as one that has never slept but for what that one has moved in the meantime, at less than
    /// [`SleepParams::speed`]. A groom that is not measured ([`HairSim::request_motion`]) never sleeps.
    ///
    /// It takes 16 bytes a guide vertex.
    ///
    /// # Errors
    /// A parameter outside its range, or what the backend says; nothing changes then.
    pub fn allow_sleep(&mut self, backend: &mut dyn Backend, params: SleepParams) -> Result<(), SimError> {
        params.validate()?;
        if let Some(sleep) = &mut self.sleep {
            sleep.params = params;
            sleep.wake();
            return Ok(());
        }
        let Self { sections, kernels, shared, owner, .. } = self;
        let mut compiled = kernels.clone();
        let measure = owner.change(backend, |backend| {
            let largest = storage(backend, "hair.moved", 4, 1)?;
            let mut passes = Vec::with_capacity(sections.len());
            for section in sections.iter() {
                passes.push(section.measure(backend, &mut compiled, shared, largest)?);
            }
            Ok::<_, tressfx_core::Error>(Measure { passes, largest })
        })?;
        *kernels = compiled;
        self.sleep = Some(Sleep::new(params, measure));
        Ok(())
    }

    /// Measures how far strands move, behind [`HairSim::step`] of this frame; every 10 frames or so is often enough. When the bytes have come back, some
    /// frames later, [`HairSim::measured_motion`] takes them. Nothing is recorded and none comes back of a groom that sleeps, or that may not, or where no time has passed;
    /// the first measurement after something has changed notes where strands are, and none comes back either.
    pub fn request_motion(&mut self, list: &mut PassList) -> Option<MotionTicket> {
        let time = self.clock.time();
        self.sleep.as_mut()?.request(list, time)
    }

    /// Takes what [`HairSim::request_motion`] has asked for: four bytes. One from before the last change is not looked at.
    pub fn measured_motion(&mut self, ticket: &MotionTicket, bytes: [u8; 4]) {
        self.sleep.iter_mut().for_each(|sleep| sleep.take(ticket, f32::from_le_bytes(bytes)));
    }

    /// Whether it sleeps.
    pub fn is_asleep(&self) -> bool {
        self.sleep.as_ref().is_some_and(Sleep::is_asleep)
    }

    /// Wakes it for the next frame: for what it cannot know, such as [`HairSim::root_transforms`] that a kernel has written.
    pub fn wake(&mut self) {
        self.sleep.iter_mut().for_each(Sleep::wake);
    }

    /// Whether it sleeps, and a frame is the same again.
    pub(super) fn sleeps_on_in(&self, input: &StepInput) -> bool {
        self.sleep.as_ref().is_some_and(|sleep| sleep.goes_on_in(input))
    }

    /// Takes note of what a frame is given.
    pub(super) fn note(&mut self, input: &StepInput) {
        self.sleep.iter_mut().for_each(|sleep| sleep.note(input));
    }
}
