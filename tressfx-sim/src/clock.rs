//! Divides frames of any length into sub-steps of one length.

mod head_path;
mod params;
mod sub_step;
#[cfg(test)]
mod tests;

use glam::{DVec3, Quat, Vec3};
use tressfx_core::strands::Bounds;
use tressfx_core::view::Pose;

use crate::params::ParamError;
use head_path::{END, EarlierFrame, HeadPath, bend};
pub use params::ClockParams;
pub use sub_step::{FramePlan, RootPath, SubStep};

/// Cuts frames into sub-steps.
#[derive(Clone, Debug)]
pub struct Clock {
    params: ClockParams,
    bounds: Bounds,
    /// The point of the rest pose that positions are relative to.
    center: Vec3,
    /// Simulated time, s.
    time: f64,
    /// Time of earlier frames that is not simulated yet, s.
    behind: f64,
    /// Length of the last sub-step, s.
    last_sub_step: f64,
    /// The head at the end of the last frame; `None` asks for a reset.
    head: Option<Pose>,
    /// For the last frame and for the one before it: the head at its start, and its length in s.
    before: [Option<(Pose, f64)>; 2],
    /// The head at the end of the last sub-step.
    simulated_head: Pose,
    /// See [`Clock::pose`]: kept, since a groom that sleeps is asked for it in each frame.
    pose: Pose,
    /// Lengths of the last frame and of the one before it, s, where roots were on one way in them.
    root_frames: [Option<f64>; 2],
    /// Velocities of the corners of the bounds in the last frame.
    velocities: Option<[Vec3; 8]>,
    /// Sub-steps in a second.
    rate: f64,
    /// Where the head stands still and frames have passed: the lengths of the last two, s, which `before` has not been told yet.
    still: Option<[f64; 2]>,
}

/// Frames whose lengths differ by more than this factor do not count as one motion.
const MAX_LENGTH_RATIO: f64 = 2.0;
/// A sub-step is simulated if no more than this share of its length is missing, so that rounding does not delay it to the
/// next frame: 2 s have the same number of sub-steps at any frame rate.
const TOLERANCE: f64 = 1e-6;

impl Clock {
    /// A clock for a groom with these bounds, at 0 s.
    ///
    /// # Errors
    /// See [`ClockParams::validate`].
    pub fn new(params: ClockParams, bounds: Bounds) -> Result<Self, ParamError> {
        params.validate()?;
        let (last_sub_step, center) = (params.sub_step, bounds.rounded_center());
        Ok(Self {
            params,
            bounds,
            center,
            time: 0.0,
            behind: 0.0,
            last_sub_step,
            head: None,
            before: [None; 2],
            root_frames: [None; 2],
            simulated_head: Pose::IDENTITY,
            pose: drawn(center, &Pose::IDENTITY, &Pose::IDENTITY),
            velocities: None,
            rate: params.sub_step.recip(),
            still: None,
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
        self.rate = params.sub_step.recip();
        Ok(())
    }

    /// Simulated time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Asks for a reset in the next frame.
    pub fn reset(&mut self) {
        self.head = None;
        self.pose = drawn(self.center, &self.simulated_head, &self.simulated_head);
    }

    /// The point of the rest pose that positions are relative to.
    pub fn center(&self) -> Vec3 {
        self.center
    }

    /// Transforms positions from after the last sub-step to the world: the translation is where the centre is now, the
    /// rotation is that of the head since that sub-step.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Divides a frame of `dt` seconds, at whose end the head is at `head`, into sub-steps. Within the frame the head
    /// continues its motion of the last two frames.
    pub fn advance(&mut self, dt: f64, head: Pose) -> FramePlan {
        let mut frame = self.advance_part(dt, head);
        self.move_roots(dt.max(0.0), &mut frame);
        frame
    }

    /// A frame, or a part of one, without the ways of roots.
    fn advance_part(&mut self, dt: f64, head: Pose) -> FramePlan {
        self.settle();
        let teleported = self.head.is_some_and(|last| self.is_teleport(&last, &head));
        let start = if teleported { None } else { self.head };
        let mut frame = FramePlan { teleported, ..FramePlan::default() };
        let last = start.unwrap_or_else(|| {
            frame.reset = Some(head.rotation);
            self.simulated_head = head;
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
        let count = self.count(simulated);
        for index in 1..=count {
            let into_frame = f64::from(index) * length - self.behind;
            // If the sub-step was made shorter, sub-steps may end before the frame begins, or in a frame of length 0.
            let share = if simulated > 0.0 { into_frame / simulated } else { 1.0 };
            let pose = path.at(share.max(0.0));
            self.time += length;
            frame.sub_steps.push(SubStep {
                length,
                length_ratio: length / self.last_sub_step,
                time: self.time,
                head_rotation: pose.rotation,
                head_turn: rotation_between(self.simulated_head.rotation, pose.rotation),
                center_displacement: self.displacement(&self.simulated_head, &pose).as_vec3(),
                head_acceleration: acceleration,
                heads: [self.simulated_head, pose],
                shares: [share - if simulated > 0.0 { length / simulated } else { 0.0 }, share],
                roots: RootPath::END,
            });
            self.simulated_head = pose;
            self.last_sub_step = length;
        }
        self.behind += simulated - f64::from(count) * length;
        self.head = Some(head);
        self.pose = drawn(self.center, &self.simulated_head, &head);
        self.before = match frame.reset.is_none() && frame.dropped == 0.0 {
            true => [Some((last, dt)), self.before[0]],
            false => [None; 2],
        };
        frame
    }

    /// What [`Clock::advance`] does where the head stands still and nobody asks for the sub-steps.
    pub fn pass(&mut self, dt: f64) {
        let Some(head) = self.head else { return };
        let dt = dt.max(0.0);
        let dropped = (self.behind + dt - self.params.max_frame).clamp(0.0, dt);
        let length = self.params.sub_step;
        let count = self.count(dt - dropped);
        // As often as there are sub-steps: a product would be rounded in another way.
        (0..count).for_each(|_| self.time += length);
        self.behind += dt - dropped - f64::from(count) * length;
        if count > 0 {
            self.last_sub_step = length;
        }
        self.end_root_frame(dt, dropped == 0.0);
        if let Some([last, _]) = self.still.filter(|_| dt > 0.0 && dropped == 0.0) {
            self.still = Some([dt, last]);
        } else {
            self.come_to_rest(dt, dropped, count, head);
        }
    }

    /// The frames in which a head that stands still did not before, and those of no length. Apart from those that follow, in a function that need not save registers.
    #[inline(never)]
    fn come_to_rest(&mut self, dt: f64, dropped: f64, count: u32, head: Pose) {
        self.settle();
        if count > 0 && self.simulated_head != head {
            self.simulated_head = head;
            self.pose = drawn(self.center, &head, &head);
        }
        if dt > 0.0 {
            self.velocities = Some([Vec3::ZERO; 8]);
        }
        self.before = if dropped == 0.0 { [Some((head, dt)), self.before[0]] } else { [None; 2] };
        let at_head = |frame: Option<(Pose, f64)>| frame.filter(|(pose, _)| *pose == head).map(|(_, length)| length);
        self.still = match self.before.map(at_head) {
            [Some(last), Some(earlier)] if dt > 0.0 && self.simulated_head == head => Some([last, earlier]),
            _ => None,
        };
    }

    /// Writes down what has passed.
    fn settle(&mut self) {
        if let (Some(lengths), Some(head)) = (self.still.take(), self.head) {
            self.before = lengths.map(|length| Some((head, length)));
        }
    }

    /// Sub-steps in so many more seconds.
    fn count(&self, simulated: f64) -> u32 {
        ((self.behind + simulated) * self.rate + TOLERANCE) as u32
    }

    /// The same where the head is known within the frame too: at even distances in time, it was at these poses before it came
    /// to `head`. The sub-steps are those of as many shorter frames, with the shares of the whole frame.
    ///
    /// Of a frame without a length, or one that is too long, the poses are not looked at.
    pub fn advance_along(&mut self, dt: f64, poses: &[Pose], head: Pose) -> FramePlan {
        if poses.is_empty() || dt <= 0.0 || self.behind + dt > self.params.max_frame {
            return self.advance(dt, head);
        }
        let parts = (poses.len() + 1) as f64;
        let mut frame = FramePlan::default();
        for (index, &pose) in poses.iter().chain([&head]).enumerate() {
            let part = self.advance_part(dt / parts, pose);
            if part.reset.is_some() {
                frame.sub_steps.clear();
                frame.reset = part.reset;
            }
            frame.teleported |= part.teleported;
            let before = index as f64;
            frame.sub_steps.extend(
                part.sub_steps.into_iter().map(|sub_step| SubStep {
                    shares: sub_step.shares.map(|share| (before + share) / parts),
                    ..sub_step
                }),
            );
        }
        self.move_roots(dt, &mut frame);
        frame
    }

    /// Says where roots are at the ends of the sub-steps of a whole frame. They have only one way in it, however many poses of the head
    /// there are. Where strands were reset in it, roots are where they are at its end.
    fn move_roots(&mut self, dt: f64, frame: &mut FramePlan) {
        let simulated = dt - frame.dropped;
        if frame.reset.is_none() {
            let before = self.root_frames.map(|length| length.map(|length| length / simulated).filter(are_alike));
            for sub_step in frame.sub_steps.iter_mut().filter(|sub_step| sub_step.shares[1] < END) {
                let share = sub_step.shares[1].max(0.0);
                sub_step.roots = RootPath { share, bend: bend(before, share), frame: simulated };
            }
        }
        self.end_root_frame(dt, frame.reset.is_none() && frame.dropped == 0.0);
    }

    /// A frame of this length ends; whether roots were on one way in it, and in those before.
    fn end_root_frame(&mut self, dt: f64, is_one_way: bool) {
        self.root_frames = if is_one_way { [Some(dt), self.root_frames[0]] } else { [None; 2] };
    }

    /// The path of the head in a frame of which `simulated` seconds are simulated.
    fn path(&self, simulated: f64, last: Pose, head: Pose) -> HeadPath {
        let before = self.before.map(|before| before.map(|(head, dt)| EarlierFrame { head, length: dt / simulated }));
        HeadPath::new(before.map(|before| before.filter(|before| are_alike(&before.length))), last, head)
    }

    /// The displacement of the groom's centre.
    fn displacement(&self, from: &Pose, to: &Pose) -> DVec3 {
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

/// Whether frames count as one motion, by the length of one over that of the other.
fn are_alike(ratio: &f64) -> bool {
    (1.0 / MAX_LENGTH_RATIO..=MAX_LENGTH_RATIO).contains(ratio)
}

fn corners(bounds: &Bounds) -> [Vec3; 8] {
    std::array::from_fn(|corner| {
        let pick = |bit: usize, min, max| if corner & bit == 0 { min } else { max };
        let (min, max) = (bounds.min, bounds.max);
        Vec3::new(pick(1, min.x, max.x), pick(2, min.y, max.y), pick(4, min.z, max.z))
    })
}

/// See [`Clock::pose`].
fn drawn(center: Vec3, simulated: &Pose, head: &Pose) -> Pose {
    let translation = carried(center, head).as_vec3();
    Pose { rotation: rotation_between(simulated.rotation, head.rotation), translation }
}

/// Where the head carries a point.
fn carried(point: Vec3, head: &Pose) -> DVec3 {
    head.rotation.as_dquat().normalize() * point.as_dvec3() + head.translation.as_dvec3()
}

/// The rotation that takes `from` to `to`; the identity exactly for a head at rest.
fn rotation_between(from: Quat, to: Quat) -> Quat {
    if from == to { Quat::IDENTITY } else { (to * from.inverse()).normalize() }
}
