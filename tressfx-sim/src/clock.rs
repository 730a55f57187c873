//! From frames of any length to sub-steps of one length.

use glam::{DVec3, Quat, Vec3};
use serde::{Deserialize, Serialize};
use tressfx_core::strands::Bounds;
use tressfx_core::view::Pose;

use crate::error::SimError;
use crate::params::{ParamError, within};
use crate::path::{Before, Path};
use crate::wind::Wind;

/// How time is cut, and what counts as a teleport. The same for all sections.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ClockParams {
    /// Length of a sub-step, s. 1/120 is where the local shape constraints are stiff and still come to rest: they push two
    /// vertices of a strand without an answer from the edge before, which can feed energy in, and it is the sub-step that
    /// takes it out again. Curls that are neither soft nor stiff tremble at 1/240.
    pub sub_step: f64,
    /// The most time that one frame simulates, s; the rest is dropped, and reported.
    pub max_frame: f64,
    /// A head that moves further than this in one frame has teleported; in radii of the groom.
    pub teleport_distance: f32,
    /// A head that turns further than this in one frame has teleported; radians, pi or more: never.
    pub teleport_angle: f32,
}

impl Default for ClockParams {
    fn default() -> Self {
        Self { sub_step: 1.0 / 120.0, max_frame: 0.1, teleport_distance: 10.0, teleport_angle: 2.0 }
    }
}

impl ClockParams {
    /// Checks every parameter.
    ///
    /// # Errors
    /// The first parameter outside its range, with its value and the range.
    pub fn validate(&self) -> Result<(), ParamError> {
        within("sub_step", self.sub_step, 1e-5..=0.1)?;
        within("max_frame", self.max_frame, self.sub_step..=10.0)?;
        within("teleport_distance", self.teleport_distance, 0.0..=f32::MAX)?;
        within("teleport_angle", self.teleport_angle, 0.0..=f32::MAX)
    }
}

/// What one frame is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInput {
    /// Seconds since the last frame; 0 or less simulates nothing.
    pub dt: f64,
    /// Where the head is at the end of the frame: from the space of the rest pose to the world, in the unit of the file.
    pub head: Pose,
    /// The wind, if any.
    pub wind: Option<Wind>,
}

impl StepInput {
    /// A frame without wind.
    pub fn new(dt: f64, head: Pose) -> Self {
        Self { dt, head, wind: None }
    }

    /// Checks it.
    ///
    /// # Errors
    /// What is not finite, and what is wrong with the wind.
    pub fn validate(&self) -> Result<(), SimError> {
        let numbers = [
            ("dt", self.dt.is_finite()),
            ("head.rotation", self.head.rotation.is_finite() && self.head.rotation.length_squared() > 0.5),
            ("head.translation", self.head.translation.is_finite()),
        ];
        if let Some((name, _)) = numbers.iter().find(|(_, finite)| !finite) {
            return Err(SimError::NonFinite { name });
        }
        self.wind.iter().try_for_each(Wind::validate)
    }
}

/// One sub-step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubStep {
    /// Its length, s.
    pub length: f64,
    /// Length of this one over that of the one before: 1, but for the first one after a change of [`ClockParams`].
    pub length_ratio: f64,
    /// Simulated time at its end, s.
    pub time: f64,
    /// The rotation of the head at its end.
    pub rotation: Quat,
    /// The rotation of the head during it; the identity exactly if it has not turned.
    pub turn: Quat,
    /// The way of the groom's centre during it, units of the file; 0 exactly if the head has not moved.
    pub shift: Vec3,
    /// The acceleration of the head in this frame, the largest within the groom's bounds, units of the file / s^2.
    pub acceleration: f32,
}

/// What one frame consists of.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// The strands go to rest on a head that is turned so, before the sub-steps.
    pub reset: Option<Quat>,
    /// Whether that is because of a teleport.
    pub teleported: bool,
    /// What is simulated, in order.
    pub sub_steps: Vec<SubStep>,
    /// Time that was dropped because the frame was too long, s.
    pub dropped: f64,
}

/// Cuts frames into sub-steps.
#[derive(Clone, Debug)]
pub struct Clock {
    params: ClockParams,
    bounds: Bounds,
    /// What positions are about, in the rest pose.
    center: Vec3,
    /// Simulated time, s.
    time: f64,
    /// Time that is not simulated yet, s.
    behind: f64,
    last_length: f64,
    /// The head at the end of the last frame; `None` asks for a reset.
    head: Option<Pose>,
    /// The head at the start of the last frame and at that of the one before, and those frames' lengths, s.
    before: [Option<(Pose, f64)>; 2],
    /// The head at the end of the last sub-step.
    simulated: Pose,
    /// Velocities of the corners of the bounds in the last frame.
    velocities: Option<[Vec3; 8]>,
}

/// How far, as a factor, the lengths of two frames may differ for both to tell of the same motion.
const ALIKE: f64 = 2.0;
/// A share of a sub-step that is not worth waiting for: so that 2 s are as many sub-steps at any frame rate.
const TOLERANCE: f64 = 1e-6;

impl Clock {
    /// A clock for a groom with these bounds, at 0 s.
    ///
    /// # Errors
    /// See [`ClockParams::validate`].
    pub fn new(params: ClockParams, bounds: Bounds) -> Result<Self, ParamError> {
        params.validate()?;
        let last_length = params.sub_step;
        Ok(Self {
            params,
            bounds,
            center: bounds.coarse_center(),
            time: 0.0,
            behind: 0.0,
            last_length,
            head: None,
            before: [None; 2],
            simulated: Pose::IDENTITY,
            velocities: None,
        })
    }

    /// The parameters.
    pub fn params(&self) -> &ClockParams {
        &self.params
    }

    /// Changes the parameters, from the next frame on.
    ///
    /// # Errors
    /// See [`ClockParams::validate`].
    pub fn set_params(&mut self, params: ClockParams) -> Result<(), ParamError> {
        params.validate()?;
        self.params = params;
        Ok(())
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Asks for a reset in the next frame.
    pub fn reset(&mut self) {
        self.head = None;
    }

    /// The point of the rest pose that positions are about.
    pub fn center(&self) -> Vec3 {
        self.center
    }

    /// From positions after the last sub-step to the world: where the head carries the centre now, and how far it has turned
    /// since that sub-step.
    pub fn pose(&self) -> Pose {
        let head = self.head.unwrap_or(self.simulated);
        let translation = carried(self.center, &head).as_vec3();
        Pose { rotation: turn(self.simulated.rotation, head.rotation), translation }
    }

    /// Cuts a frame. The head goes on during it as it did in the last two.
    pub fn advance(&mut self, dt: f64, head: Pose) -> Frame {
        let teleported = self.head.is_some_and(|last| self.is_teleport(&last, &head));
        let start = if teleported { None } else { self.head };
        let mut frame = Frame { teleported, ..Frame::default() };
        let last = start.unwrap_or_else(|| {
            frame.reset = Some(head.rotation);
            self.simulated = head;
            self.velocities = None;
            self.before = [None; 2];
            head
        });
        let acceleration = self.acceleration(dt, &last, &head);
        let dt = dt.max(0.0);
        frame.dropped = (self.behind + dt - self.params.max_frame).clamp(0.0, dt);
        let simulated = dt - frame.dropped;
        let path = self.path(simulated, last, head);
        let length = self.params.sub_step;
        let count = ((self.behind + simulated) / length + TOLERANCE).floor() as u32;
        for index in 1..=count {
            let into_frame = f64::from(index) * length - self.behind;
            let pose = path.at(into_frame / simulated);
            self.time += length;
            frame.sub_steps.push(SubStep {
                length,
                length_ratio: length / self.last_length,
                time: self.time,
                rotation: pose.rotation,
                turn: turn(self.simulated.rotation, pose.rotation),
                shift: self.way(&self.simulated, &pose).as_vec3(),
                acceleration,
            });
            self.simulated = pose;
            self.last_length = length;
        }
        self.behind += simulated - f64::from(count) * length;
        self.head = Some(head);
        self.before = match frame.reset.is_none() && frame.dropped == 0.0 {
            true => [Some((last, dt)), self.before[0]],
            false => [None; 2],
        };
        frame
    }

    /// The way of the head in a frame of which so much time is simulated.
    fn path(&self, simulated: f64, last: Pose, head: Pose) -> Path {
        let before = self.before.map(|before| before.map(|(head, dt)| Before { head, length: dt / simulated }));
        let alike = |before: &Before| (1.0 / ALIKE..=ALIKE).contains(&before.length);
        Path::new(before.map(|before| before.filter(alike)), last, head)
    }

    /// The way of the groom's centre.
    fn way(&self, from: &Pose, to: &Pose) -> DVec3 {
        if from == to { DVec3::ZERO } else { carried(self.center, to) - carried(self.center, from) }
    }

    fn is_teleport(&self, last: &Pose, head: &Pose) -> bool {
        let center = self.bounds.center();
        let distance = head.transform(center).distance(last.transform(center));
        let angle = last.rotation.angle_between(head.rotation);
        distance > self.params.teleport_distance * self.bounds.radius() || angle > self.params.teleport_angle
    }

    fn acceleration(&mut self, dt: f64, last: &Pose, head: &Pose) -> f32 {
        if dt <= 0.0 {
            return 0.0;
        }
        let dt = dt as f32;
        let now = corners(&self.bounds).map(|corner| (head.transform(corner) - last.transform(corner)) / dt);
        let before = self.velocities.replace(now).unwrap_or(now);
        now.iter().zip(before).map(|(now, before)| now.distance(before) / dt).fold(0.0, f32::max)
    }
}

fn corners(bounds: &Bounds) -> [Vec3; 8] {
    std::array::from_fn(|corner| {
        let pick = |bit: usize, min, max| if corner & bit == 0 { min } else { max };
        let (min, max) = (bounds.min, bounds.max);
        Vec3::new(pick(1, min.x, max.x), pick(2, min.y, max.y), pick(4, min.z, max.z))
    })
}

/// Where the head carries a point.
fn carried(point: Vec3, head: &Pose) -> DVec3 {
    head.rotation.as_dquat().normalize() * point.as_dvec3() + head.translation.as_dvec3()
}

/// The rotation that takes `from` to `to`; the identity exactly for a head at rest.
fn turn(from: Quat, to: Quat) -> Quat {
    if from == to { Quat::IDENTITY } else { (to * from.inverse()).normalize() }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn clock() -> Clock {
        let bounds = Bounds { min: Vec3::splat(-0.1), max: Vec3::splat(0.1) };
        let mut clock = Clock::new(ClockParams::default(), bounds).unwrap();
        let frame = clock.advance(0.0, Pose::IDENTITY);
        assert_eq!((frame.reset, frame.sub_steps.len()), (Some(Quat::IDENTITY), 0));
        clock
    }

    fn moved(x: f32) -> Pose {
        Pose { translation: Vec3::X * x, ..Pose::IDENTITY }
    }

    #[test]
    fn two_seconds_are_as_many_sub_steps_at_any_frame_rate() {
        for fps in [24, 30, 60, 72, 90, 120, 144, 240, 1000] {
            let mut clock = clock();
            let frames = (0..2 * fps).map(|_| clock.advance(1.0 / f64::from(fps), Pose::IDENTITY));
            assert_eq!(frames.map(|frame| frame.sub_steps.len()).sum::<usize>(), 240, "{fps} fps");
            assert!((clock.time() - 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn the_head_moves_evenly_in_the_first_frame_and_arrives() {
        let mut clock = clock();
        let frame = clock.advance(1.0 / 60.0, moved(0.2));
        let shifts: Vec<f32> = frame.sub_steps.iter().map(|sub_step| sub_step.shift.x).collect();
        assert!(shifts.iter().all(|shift| (shift - 0.1).abs() < 1e-6), "{shifts:?}");
        assert_eq!(clock.pose(), moved(0.2), "the end of the frame is met exactly");
        // Half of a sub-step: the strands stay, and the renderer is told where they are to be.
        let frame = clock.advance(1.0 / 240.0, moved(0.25));
        assert!(frame.sub_steps.is_empty());
        assert_eq!(clock.pose(), moved(0.25));
        let frame = clock.advance(1.0 / 240.0, moved(0.35));
        assert!((frame.sub_steps[0].shift.x - 0.15).abs() < 1e-6);
    }

    #[test]
    fn strands_turn_and_move_with_the_head_about_their_centre() {
        let bounds = Bounds { min: Vec3::new(-0.1, 1.5, -0.1), max: Vec3::new(0.1, 1.7, 0.1) };
        let mut clock = Clock::new(ClockParams::default(), bounds).unwrap();
        assert!(clock.center().distance(bounds.center()) < 0.01);
        let head = |angle: f32| Pose { rotation: Quat::from_rotation_z(angle), translation: Vec3::X * angle };
        clock.advance(0.0, head(0.0));
        let point = Vec3::new(0.05, 1.55, -0.02);
        let mut place = (point - clock.center()).as_dvec3();
        let mut center = clock.center().as_dvec3();
        for frame in 1..=30 {
            let head = head(0.02 * frame as f32);
            for sub_step in clock.advance(1.0 / 60.0, head).sub_steps {
                place = sub_step.turn.as_dquat() * place;
                center += sub_step.shift.as_dvec3();
            }
            let carried = head.transform(point);
            assert!((center + place).as_vec3().distance(carried) < 2e-6, "the head carries it to {carried}");
            assert!(
                clock.pose().transform(place.as_vec3()).distance(carried) < 1e-6,
                "and the renderer draws it there"
            );
        }
        // Less than a sub-step later the strands have not turned yet.
        let head = head(0.605);
        assert!(clock.advance(1.0 / 240.0, head).sub_steps.is_empty());
        assert!(clock.pose().transform(place.as_vec3()).distance(head.transform(point)) < 1e-6);
    }

    /// Places of a head that is in one now, within the frames that bring it to these places.
    fn places(clock: &mut Clock, dt: f64, ends: &[f32]) -> Vec<f32> {
        let mut place = clock.pose().translation.x;
        let mut places = Vec::new();
        for &end in ends {
            let frame = clock.advance(dt, moved(end));
            if frame.reset.is_some() {
                place = end;
            }
            for sub_step in frame.sub_steps {
                place += sub_step.shift.x;
                places.push(place);
            }
        }
        places
    }

    #[test]
    fn the_head_goes_on_as_it_did_where_the_last_frame_tells_how() {
        let close = |is: &[f32], should_be: &[f32]| {
            assert!(is.iter().zip(should_be).all(|(one, other)| (one - other).abs() < 1e-5), "{is:?} {should_be:?}");
        };
        let mut one = clock();
        close(&places(&mut one, 1.0 / 60.0, &[0.0, 0.4]), &[0.0, 0.0, 0.15, 0.4]);
        one.reset();
        close(&places(&mut one, 1.0 / 60.0, &[0.5, 0.7]), &[0.5, 0.5, 0.6, 0.7]);
        // A frame of another length, one that was too long, and a teleport tell nothing.
        close(&places(&mut one, 1.0 / 24.0, &[0.7]), &[0.7; 5]);
        close(&places(&mut one, 1.0 / 60.0, &[0.9]), &[0.8, 0.9]);
        one.advance(10.0, moved(0.0));
        close(&places(&mut one, 0.1, &[1.2])[..2], &[0.1, 0.2]);
        assert!(one.advance(1.0 / 60.0, moved(50.0)).teleported);
        close(&places(&mut one, 1.0 / 60.0, &[50.2]), &[50.1, 50.2]);
    }

    #[test]
    fn a_head_at_rest_makes_no_motion_at_all() {
        let mut clock = clock();
        let head = Pose { rotation: Quat::from_rotation_x(0.3), translation: Vec3::new(0.1, 0.2, 0.3) };
        clock.advance(0.1, head);
        let frame = clock.advance(0.1, head);
        assert!(frame.sub_steps.iter().all(|sub_step| sub_step.turn == Quat::IDENTITY && sub_step.shift == Vec3::ZERO));
        assert!(frame.sub_steps.iter().all(|sub_step| sub_step.rotation == head.rotation));
    }

    #[test]
    fn the_acceleration_is_that_of_the_frames() {
        let mut clock = clock();
        let dt = 1.0 / 60.0;
        let at = |frame: f32| moved(0.5 * 12.0 * (frame / 60.0).powi(2));
        let accelerations = (1..10).map(|frame| clock.advance(dt, at(frame as f32)).sub_steps[0].acceleration);
        let accelerations: Vec<f32> = accelerations.collect();
        assert_eq!(accelerations[0], 0.0, "one frame knows no acceleration");
        assert!(accelerations[1..].iter().all(|acceleration| (acceleration - 12.0).abs() < 0.1), "{accelerations:?}");
    }

    proptest! {
        #[test]
        fn time_is_simulated_or_dropped_and_never_lost(steps in prop::collection::vec(-0.1..0.5f64, 1..60)) {
            let mut clock = clock();
            let (mut passed, mut dropped, mut sub_steps) = (0.0, 0.0, 0);
            for dt in steps {
                let frame = clock.advance(dt, Pose::IDENTITY);
                prop_assert!(frame.sub_steps.len() <= 12);
                passed += dt.max(0.0);
                dropped += frame.dropped;
                sub_steps += frame.sub_steps.len();
            }
            let behind = passed - dropped - sub_steps as f64 / 120.0;
            prop_assert!((-1e-6..1.0 / 120.0 + 1e-6).contains(&behind), "{} s are neither", behind);
            prop_assert!((clock.time() - sub_steps as f64 / 120.0).abs() < 1e-9);
        }
    }
}
