//! What happens around the strands: heads, roots, wind, colliders, frame times.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{Quat, Vec3};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::Bounds;
use tressfx_core::view::Pose;
use tressfx_sim::{Collider, SimParams, Wind};

use crate::case::SolverName;
use crate::dice::{Dice, Rolls};
use crate::params::{SUB_STEPS_A_FRAME, sim_params};

/// What one frame is given, and what is changed before it.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Seconds since the last frame.
    pub dt: f64,
    /// Where the head is at its end.
    pub head: Pose,
    /// The wind.
    pub wind: Option<Wind>,
    /// What is collided with.
    pub colliders: Vec<Collider<'static>>,
    /// Where the roots go, a pose a guide.
    pub roots: Option<Vec<Pose>>,
    /// What the caller changes before it.
    pub change: Option<Change>,
}

/// What a caller may do between frames.
#[derive(Clone, Debug)]
pub enum Change {
    /// Other parameters.
    Params(Box<SimParams>),
    /// A sub-step of another length, s.
    SubStep(f64),
    /// The strands go to their rest pose.
    Reset,
}

/// How a head moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeadMotion {
    /// Not at all.
    Still,
    /// Even, with steps.
    Walking,
    /// To and fro.
    Shaking,
    /// 100 m from one frame to the next, now and then.
    Jumping,
    /// 100 turns a second.
    Spinning,
    /// Anywhere, in each frame.
    Anywhere,
}

const HEADS: [HeadMotion; 7] = [
    HeadMotion::Still,
    HeadMotion::Still,
    HeadMotion::Walking,
    HeadMotion::Shaking,
    HeadMotion::Jumping,
    HeadMotion::Spinning,
    HeadMotion::Anywhere,
];

/// What the surroundings of a groom are sized for.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The box around the groom, in the unit of the file.
    pub bounds: Bounds,
    /// Metres that a unit of the file stands for.
    pub metres_per_unit: f32,
    /// What moves the strands.
    pub solver: SolverName,
    /// Guides of the groom.
    pub guides: u32,
    /// The most colliders of a frame.
    pub most_colliders: u32,
    /// The longest frame that is simulated, s.
    pub max_frame: f64,
}

/// What happens in a case.
#[derive(Clone, Debug)]
pub struct Script {
    /// How the head moves.
    pub head: HeadMotion,
    /// Whether roots have transforms of their own.
    pub own_roots: bool,
    /// The wild part, after a first frame that only puts the strands in place.
    pub frames: Vec<Frame>,
    /// What is collided with in the calm after it.
    pub resting_on: Vec<Collider<'static>>,
    /// Whether nothing happens that could give strands energy: a still head, no wind, no colliders, no changes.
    pub is_left_alone: bool,
}

/// Random surroundings.
pub fn script(dice: Dice, place: &Place, most_frames: u32) -> Script {
    let mut rolls = dice.of("script");
    let head = rolls.one_of(&HEADS);
    let is_left_alone = head == HeadMotion::Still && rolls.chance(0.7);
    let own_roots = !is_left_alone && rolls.chance(0.2);
    let frames = rolls.whole(most_frames.min(4)..=most_frames);
    let wind = (!is_left_alone && rolls.chance(0.5)).then(|| wind(&mut dice.of("wind")));
    let colliders = if is_left_alone || rolls.chance(0.4) { 0 } else { rolls.whole(0..=place.most_colliders) };
    let (mut heads, mut times) = (HeadPath::new(dice, head, place), dice.of("frame times"));
    let mut objects = Objects::new(dice, place, colliders);
    let (mut roots, mut changes) = (dice.of("roots"), dice.of("changes"));
    let changes_often = !is_left_alone && rolls.chance(0.2);
    let usual_times = rolls.chance(0.3);
    let frames = (0..frames).map(|_| {
        let dt = if usual_times { 1.0 / 60.0 } else { frame_time(&mut times) };
        Frame {
            dt,
            head: heads.after(dt),
            wind: wind.filter(|_| rolls.chance(0.9)),
            colliders: objects.next(),
            roots: (own_roots && rolls.chance(0.6)).then(|| root_poses(&mut roots, place)),
            change: (changes_often && rolls.chance(0.2)).then(|| change(&mut changes, place)),
        }
    });
    let frames: Vec<_> = frames.collect();
    let resting_on = if rolls.chance(0.5) { objects.still() } else { Vec::new() };
    Script { head, own_roots, frames, resting_on, is_left_alone }
}

/// Frames of usual lengths, of none, of a day, backwards, and hitches.
fn frame_time(rolls: &mut Rolls) -> f64 {
    match rolls.whole(0..=19) {
        0 => 0.0,
        1 => 86_400.0,
        2 => -1.0,
        3 => 1e-9,
        4 => 0.5,
        5 => rolls.decades(1e-6..=10.0),
        _ => rolls.one_of(&[1.0 / 60.0, 1.0 / 60.0, 1.0 / 30.0, 1.0 / 144.0, 1.0 / 24.0, 1.0 / 10.0]),
    }
}

fn wind(rolls: &mut Rolls) -> Wind {
    let speed = if rolls.chance(0.1) { rolls.decades(1e2..=1e5) } else { rolls.decades(1e-3..=1e2) };
    Wind {
        velocity: rolls.direction() * speed as f32,
        half_angle: rolls.even(0.0..=FRAC_PI_2 - 1e-6) as f32,
        gust_period: rolls.decades(0.0011..=9e5) as f32,
    }
}

fn change(rolls: &mut Rolls, place: &Place) -> Change {
    match rolls.whole(0..=2) {
        0 => Change::Params(Box::new(sim_params(Dice::new(rolls.whole(0..=u32::MAX).into()), place.solver))),
        1 => Change::SubStep(rolls.decades((place.max_frame / SUB_STEPS_A_FRAME).max(1e-5)..=place.max_frame.min(0.1))),
        _ => Change::Reset,
    }
}

/// Where the head is, frame by frame.
struct HeadPath {
    motion: HeadMotion,
    rolls: Rolls,
    time: f64,
    pose: Pose,
    /// Units of the file in a metre.
    metre: f32,
    axis: Vec3,
}

impl HeadPath {
    fn new(dice: Dice, motion: HeadMotion, place: &Place) -> Self {
        let mut rolls = dice.of("head");
        let is_turned = rolls.chance(0.5);
        let rotation = if is_turned { rolls.rotation() } else { Quat::IDENTITY };
        let metre = 1.0 / place.metres_per_unit;
        let far = if rolls.chance(0.1) { 1000.0 } else { 1.0 };
        let pose = Pose { rotation, translation: rolls.direction() * far * metre };
        let axis = rolls.direction();
        Self { motion, rolls, time: 0.0, pose, metre, axis }
    }

    /// After another frame.
    fn after(&mut self, dt: f64) -> Pose {
        // A head goes on while the clock stands still or goes backwards.
        let dt = if dt > 0.0 { dt.min(10.0) } else { 1.0 / 60.0 };
        self.time += dt;
        let (start, turn) = (self.pose, |axis: Vec3, angle: f64| Quat::from_axis_angle(axis, (angle % TAU) as f32));
        let swing = |hertz: f64| (TAU * hertz * self.time).sin() as f32;
        let moved = |by: Vec3| Pose { translation: start.translation + by * self.metre, ..start };
        match self.motion {
            HeadMotion::Still => start,
            HeadMotion::Walking => moved(self.axis * 1.4 * self.time as f32 + Vec3::Y * 0.03 * swing(2.0)),
            HeadMotion::Shaking => {
                let rotation = (turn(self.axis, 0.5 * f64::from(swing(1.3))) * start.rotation).normalize();
                Pose { rotation, ..moved(self.axis * 0.06 * swing(4.0)) }
            }
            HeadMotion::Jumping => {
                if self.rolls.chance(0.2) {
                    self.pose.translation += self.rolls.direction() * 100.0 * self.metre;
                }
                self.pose
            }
            HeadMotion::Spinning => {
                let rotation = (turn(self.axis, TAU * 100.0 * self.time) * start.rotation).normalize();
                Pose { rotation, ..start }
            }
            HeadMotion::Anywhere => {
                let by = self.rolls.direction() * self.rolls.decades(1e-4..=10.0) as f32;
                Pose { rotation: self.rolls.rotation(), ..moved(by) }
            }
        }
    }
}

/// Poses of the roots: small turns and shifts, sometimes of any size.
fn root_poses(rolls: &mut Rolls, place: &Place) -> Vec<Pose> {
    let radius = place.bounds.radius();
    let wild = rolls.chance(0.1);
    let mut pose = || {
        let (turn, shift) = if wild { (3.0, 10.0) } else { (0.1, 0.02) };
        let rotation = Quat::from_axis_angle(rolls.direction(), turn * rolls.share() as f32);
        Pose { rotation, translation: rolls.direction() * shift * radius }
    };
    (0..place.guides).map(|_| pose()).collect()
}

/// What strands collide with.
struct Objects {
    rolls: Rolls,
    place: Place,
    objects: Vec<(Capsule, Option<Pose>)>,
}

impl Objects {
    fn new(dice: Dice, place: &Place, count: u32) -> Self {
        let mut rolls = dice.of("colliders");
        let radius = place.bounds.radius().max(1e-6 / place.metres_per_unit);
        let objects = (0..count).map(|_| {
            let size = match rolls.whole(0..=5) {
                // It swallows the groom.
                0 => 3.0,
                1 => 0.0,
                _ => rolls.decades(0.01..=1.0) as f32,
            };
            let a = place.bounds.center() + rolls.direction() * radius * rolls.share() as f32;
            let b = if rolls.chance(0.3) { a } else { a + rolls.direction() * radius * rolls.share() as f32 };
            let other = if rolls.chance(0.5) { size } else { size * rolls.share() as f32 };
            let capsule = Capsule { a, b, radius_a: size * radius, radius_b: other * radius };
            let pose = rolls.chance(0.5).then_some(Pose::IDENTITY);
            (capsule, pose)
        });
        let objects = objects.collect();
        Self { rolls, place: *place, objects }
    }

    /// Those of the next frame: some ride on the head, others move by themselves, at up to hundreds of m/s.
    fn next(&mut self) -> Vec<Collider<'static>> {
        let metre = 1.0 / self.place.metres_per_unit;
        let rolls = &mut self.rolls;
        let mut frame = |(capsule, pose): &mut (Capsule, Option<Pose>)| {
            let Some(from) = *pose else { return Collider::with_head(*capsule) };
            let by = rolls.direction() * rolls.decades(1e-3..=3.0) as f32 * metre;
            let turn = Quat::from_axis_angle(rolls.direction(), rolls.share() as f32);
            let to = Pose { rotation: (turn * from.rotation).normalize(), translation: from.translation + by };
            *pose = Some(to);
            Collider::free(*capsule, from, to)
        };
        self.objects.iter_mut().map(&mut frame).collect()
    }

    /// The same, all riding on the head.
    fn still(&self) -> Vec<Collider<'static>> {
        self.objects.iter().map(|(capsule, _)| Collider::with_head(*capsule)).collect()
    }
}

#[cfg(test)]
mod tests {
    use tressfx_sim::StepInput;

    use super::*;

    #[test]
    fn everything_that_happens_is_legal() {
        let bounds = Bounds { min: Vec3::splat(-0.2), max: Vec3::splat(0.3) };
        let place = Place {
            bounds,
            metres_per_unit: 0.01,
            solver: SolverName::Direct,
            guides: 3,
            most_colliders: 8,
            max_frame: 0.1,
        };
        let (mut alone, mut jumps) = (0, 0);
        for seed in 0..500 {
            let script = script(Dice::new(seed), &place, 40);
            alone += u32::from(script.is_left_alone);
            for pair in script.frames.windows(2) {
                jumps += u32::from((pair[1].head.translation - pair[0].head.translation).length() > 9000.0);
            }
            for frame in &script.frames {
                let input = StepInput { wind: frame.wind, ..StepInput::new(frame.dt, frame.head) };
                input.with_colliders(&frame.colliders).validate().unwrap_or_else(|error| panic!("{seed}: {error}"));
                let quiet = frame.wind.is_none() && frame.colliders.is_empty() && frame.change.is_none();
                assert!(quiet || !script.is_left_alone, "{seed}");
            }
        }
        assert!(alone > 50 && jumps > 50, "{alone} left alone, {jumps} jumps");
    }
}
