//! Sleep: a groom whose strands have come to rest, and around which nothing changes, is not simulated.
//!
//! How far strands move is measured on the GPU, when the engine asks, and read back when it has time: nobody waits. The decision is the CPU's and
//! not the GPU's (by indirect dispatches), because a groom that sleeps then records nothing at all: a thousand of them cost neither.

use tressfx_core::id::BufferId;
use tressfx_core::pass::{PassList, Ticket};
use tressfx_core::view::Pose;

use crate::buffers::ALONE;
use crate::collider::{Collider, ColliderMotion, ColliderShape};
use crate::input::StepInput;
use crate::kernel::Pass;
use crate::params::{ParamError, within};
use crate::wind::Wind;

/// When strands are at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SleepParams {
    /// The speed below which they are, as a share of the length of the strand in a second.
    pub speed: f32,
    /// So many measurements in a row have to find that.
    pub measurements: u32,
}

impl Default for SleepParams {
    fn default() -> Self {
        Self { speed: 2e-3, measurements: 3 }
    }
}

impl SleepParams {
    /// Checks it.
    ///
    /// # Errors
    /// What is out of range.
    pub fn validate(&self) -> Result<(), ParamError> {
        within("sleep.speed", self.speed, 0.0..=1.0)?;
        within("sleep.measurements", self.measurements as f32, 1.0..=1000.0)
    }
}

/// A measurement on its way back.
#[derive(Clone, Copy, Debug)]
pub struct MotionTicket {
    /// What brings it: one `f32`.
    pub ticket: Ticket,
    /// Time in which the strands have moved by that, s.
    seconds: f64,
    /// What it was measured under.
    epoch: u64,
}

/// A collider that outlives its frame.
#[derive(Clone, Debug, PartialEq)]
struct Held {
    shape: ColliderShape,
    motion: ColliderMotion,
    except: Vec<usize>,
}

/// What a groom is given in each frame, but for the time.
#[derive(Clone, Debug, PartialEq)]
struct Surroundings {
    head: Pose,
    colliders: Vec<Held>,
}

impl Surroundings {
    fn new(input: &StepInput) -> Self {
        let held = |collider: &Collider| Held {
            shape: collider.shape,
            motion: collider.motion,
            except: collider.except.to_vec(),
        };
        Self { head: input.head, colliders: input.colliders.iter().map(held).collect() }
    }

    /// Whether a frame is the same again, and nothing moves in it.
    fn go_on_in(&self, input: &StepInput) -> bool {
        let is_same = |(held, given): (&Held, &Collider)| {
            let moves = matches!(given.motion, ColliderMotion::Free { from, to } if from != to);
            !moves && (held.shape, held.motion) == (given.shape, given.motion) && held.except == given.except
        };
        input.wind.is_none_or(|wind: Wind| wind.velocity == glam::Vec3::ZERO)
            && input.head == self.head
            && input.path.iter().all(|pose| *pose == self.head)
            && input.colliders.len() == self.colliders.len()
            && self.colliders.iter().zip(input.colliders).all(is_same)
    }
}

/// What the measurement needs on the GPU.
#[derive(Debug)]
pub(crate) struct Measure {
    /// Of each section.
    pub(crate) passes: Vec<Pass>,
    /// The bits of an `f32`.
    pub(crate) largest: BufferId,
}

/// Whether a groom may sleep, and whether it does.
#[derive(Debug)]
pub(crate) struct Sleep {
    pub(crate) params: SleepParams,
    pub(crate) measure: Measure,
    surroundings: Option<Surroundings>,
    /// Grows with every change of what the groom is given.
    epoch: u64,
    /// When it was measured last, in simulated time, and under what.
    measured: Option<(f64, u64)>,
    /// Measurements in a row that found it at rest.
    at_rest: u32,
}

impl Sleep {
    pub(crate) fn new(params: SleepParams, measure: Measure) -> Self {
        Self { params, measure, surroundings: None, epoch: 0, measured: None, at_rest: 0 }
    }

    pub(crate) fn is_asleep(&self) -> bool {
        self.at_rest >= self.params.measurements
    }

    pub(crate) fn wake(&mut self) {
        self.at_rest = 0;
        self.epoch += 1;
    }

    /// Whether it is asleep in a frame that gives what was given before, and no wind.
    pub(crate) fn goes_on_in(&self, input: &StepInput) -> bool {
        let is_given_again =
            |surroundings: &Surroundings| input.wind.is_none() && input.dt.is_finite() && surroundings.go_on_in(input);
        self.is_asleep() && self.surroundings.as_ref().is_some_and(is_given_again)
    }

    /// Takes note of what a frame is given. Wakes where that is something new.
    pub(crate) fn note(&mut self, input: &StepInput) {
        if !self.surroundings.as_ref().is_some_and(|surroundings| surroundings.go_on_in(input)) {
            self.surroundings = Some(Surroundings::new(input));
            self.wake();
        }
    }

    /// Measures how far strands have moved since the measurement before. The first one of an epoch only notes where they are.
    pub(crate) fn request(&mut self, list: &mut PassList, time: f64) -> Option<MotionTicket> {
        let before = self.measured.filter(|(_, epoch)| *epoch == self.epoch);
        let seconds = before.map(|(before, _)| time - before);
        if self.is_asleep() || seconds.is_some_and(|seconds| seconds <= 0.0) {
            return None;
        }
        list.clear(self.measure.largest, 0, 4);
        self.measure.passes.iter().for_each(|pass| pass.record(list, ALONE));
        self.measured = Some((time, self.epoch));
        let ticket =
            |seconds| MotionTicket { ticket: list.read_buffer(self.measure.largest, 0, 4), seconds, epoch: self.epoch };
        seconds.map(ticket)
    }

    /// Takes a measurement. One that was made under something else says nothing.
    pub(crate) fn take(&mut self, ticket: &MotionTicket, share: f32) {
        if ticket.epoch == self.epoch {
            let is_still = f64::from(share) <= f64::from(self.params.speed) * ticket.seconds;
            self.at_rest = if is_still { self.at_rest.saturating_add(1) } else { 0 };
        }
    }
}
