//! Plays a case on a backend.

use glam::{Quat, Vec3, Vec4};
use tressfx_core::backend::Run;
use tressfx_core::pass::PassList;
use tressfx_core::view::Pose;
use tressfx_sim::{HairSim, SectionDesc, SimError, SimParams, StepInput, StepReport};

use crate::case::Case;
use crate::motion::{Change, Frame};

/// A frame of the calm, s.
const FRAME: f64 = 1.0 / 60.0;
/// Half a second after the last disturbance strands have to be calm.
pub const CALM: f64 = 0.5;

/// Which part of a case a frame is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// The strands were just put in place.
    Start,
    /// Everything happens.
    Wild,
    /// Nothing happens any more.
    Calm,
    /// Another frame in which nothing happens, of one sub-step.
    Look,
}

/// What is seen after a frame.
#[derive(Debug)]
pub struct Sight<'a> {
    /// Where in the case it is.
    pub phase: Phase,
    /// Where all strands are, strand-major, relative to the centre of the groom on the axes of the world.
    pub positions: &'a [Vec4],
    /// Strands that were reset so far, since they had become non-finite.
    pub non_finite: u32,
    /// What the simulation says of the frame.
    pub report: StepReport,
    /// Whether the caller asked for a reset in this frame, as the first one does.
    pub asked_for_reset: bool,
    /// The length of a sub-step, s.
    pub sub_step: f64,
    /// The rotation of the head.
    pub rotation: Quat,
    /// Where the centre of the groom is in the rest pose, in the unit of the file.
    pub center: Vec3,
    /// How long nothing has happened, s.
    pub calm: f64,
    /// The parameters of now.
    pub params: &'a SimParams,
}

/// Why a case could not be played.
#[derive(Debug, thiserror::Error)]
pub enum Broken {
    /// The simulation refused what is legal.
    #[error("refused: {0}")]
    Sim(#[from] SimError),
    /// The backend failed.
    #[error("the backend: {0}")]
    Backend(#[from] tressfx_core::Error),
    /// A read-back did not come.
    #[error("a read-back is missing")]
    NoReadBack,
    /// Memory was not given back, bytes.
    #[error("{0} bytes were not given back")]
    Leak(u64),
}

/// Plays a case; `look` sees what each frame leaves.
///
/// # Errors
/// See [`Broken`].
pub fn play(backend: &mut dyn Run, case: &Case, look: &mut dyn FnMut(&Sight)) -> Result<(), Broken> {
    let before = backend.memory().bytes;
    let mut list = PassList::new();
    let mut desc = SectionDesc::new(&case.strands, case.params.clone()).with_solver(case.solver.solver());
    if case.script.own_roots {
        desc = desc.with_own_roots();
    }
    let sim = HairSim::new(backend, &mut list, &[desc], case.most_colliders())?;
    let mut player = Player { sim, case, backend, look, calm_since: None };
    let played = player.uploads(&list).and_then(|()| player.all());
    player.sim.destroy(player.backend);
    played?;
    match backend.memory().bytes.saturating_sub(before) {
        0 => Ok(()),
        bytes => Err(Broken::Leak(bytes)),
    }
}

struct Player<'a> {
    sim: HairSim,
    case: &'a Case,
    backend: &'a mut dyn Run,
    look: &'a mut dyn FnMut(&Sight),
    /// Simulated time, s.
    calm_since: Option<f64>,
}

impl Player<'_> {
    fn uploads(&mut self, list: &PassList) -> Result<(), Broken> {
        self.sim.set_clock_params(self.case.clock)?;
        Ok(self.backend.run(list)?)
    }

    fn all(&mut self) -> Result<(), Broken> {
        let frames = &self.case.script.frames;
        let head = frames.first().map_or(Pose::IDENTITY, |frame| frame.head);
        self.frame(Phase::Start, &quiet(0.0, head), true)?;
        for frame in frames {
            self.frame(Phase::Wild, frame, false)?;
            self.one_sub_step(Phase::Wild, frame.head)?;
        }
        let head = frames.last().map_or(head, |frame| frame.head);
        self.calm(head)
    }

    /// Until the time has passed; each frame is followed by one of a single sub-step, so that what strands do in it is seen.
    fn calm(&mut self, head: Pose) -> Result<(), Broken> {
        let params = *self.sim.clock_params();
        let end = self.sim.time() + CALM.min(self.case.most_sub_steps * params.sub_step);
        self.calm_since = Some(self.sim.time());
        let dt = FRAME.max(params.sub_step).min(params.max_frame);
        while self.sim.time() < end {
            let frame = Frame { colliders: self.case.script.resting_on.clone(), ..quiet(dt, head) };
            self.frame(Phase::Calm, &frame, false)?;
            self.one_sub_step(Phase::Look, head)?;
        }
        Ok(())
    }

    fn one_sub_step(&mut self, phase: Phase, head: Pose) -> Result<(), Broken> {
        if phase == Phase::Wild && !self.case.script.is_left_alone {
            return Ok(());
        }
        let sub_step = self.sim.clock_params().sub_step;
        let frame = Frame { colliders: self.case.script.resting_on.clone(), ..quiet(sub_step, head) };
        self.frame(Phase::Look, &frame, false)
    }

    fn frame(&mut self, phase: Phase, frame: &Frame, first: bool) -> Result<(), Broken> {
        let mut list = PassList::new();
        let changed = self.change(frame.change.as_ref())?;
        if let Some(roots) = &frame.roots {
            self.sim.set_roots(&mut list, 0, roots)?;
        }
        let input = StepInput { wind: frame.wind, ..StepInput::new(frame.dt, frame.head) };
        let report = self.sim.step(&mut list, &input.with_colliders(&frame.colliders))?;
        let positions = self.sim.read_positions(&mut list)[0];
        let non_finite = self.sim.read_non_finite(&mut list);
        self.backend.run(&list)?;
        let mut read = |ticket| self.backend.read(ticket).ready().ok_or(Broken::NoReadBack);
        let positions = bytemuck::pod_collect_to_vec::<u8, Vec4>(&read(positions)?);
        let non_finite = bytemuck::pod_read_unaligned(&read(non_finite)?);
        (self.look)(&Sight {
            phase,
            positions: &self.case.strands.deinterleave(&positions),
            non_finite,
            report,
            asked_for_reset: first || changed,
            sub_step: self.sim.clock_params().sub_step,
            rotation: frame.head.rotation,
            center: self.sim.center(),
            calm: self.calm_since.map_or(0.0, |since| self.sim.time() - since),
            params: self.sim.params(0),
        });
        Ok(())
    }

    /// Says whether it asks for a reset.
    fn change(&mut self, change: Option<&Change>) -> Result<bool, Broken> {
        match change {
            None => Ok(false),
            Some(Change::Reset) => {
                self.sim.reset();
                Ok(true)
            }
            Some(Change::Params(params)) => {
                self.sim.set_params(self.backend, 0, (**params).clone())?;
                Ok(false)
            }
            Some(Change::SubStep(sub_step)) => {
                let params = *self.sim.clock_params();
                let max_frame = params.max_frame.max(*sub_step);
                let sub_step = *sub_step;
                self.sim.set_clock_params(tressfx_sim::ClockParams { sub_step, max_frame, ..params })?;
                Ok(false)
            }
        }
    }
}

fn quiet(dt: f64, head: Pose) -> Frame {
    Frame { dt, head, wind: None, colliders: Vec::new(), roots: None, change: None }
}
