//! The path of the head, and of roots that move by themselves, within a frame, of which only the ends are known.

use glam::{DQuat, DVec3};
use tressfx_core::view::Pose;

/// The path from one head pose to the next: the cubic through these two and the two before. If fewer are known, it is the
/// parabola or the straight line through those.
///
/// A straight line would be off by an eighth of the acceleration times the square of the frame length, and the velocity
/// would jump at every frame. With the cubic, a head that almost stops from one frame to the next overshoots by three
/// sixteenths of its last displacement. If the two poses of a frame are equal, it does not move at all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeadPath {
    from: Pose,
    to: Pose,
    /// Relative to that of `from`.
    translation: NewtonPolynomial,
    /// Of the rotation vector from `from`.
    rotation: NewtonPolynomial,
}

/// The cubic polynomial through four points, in Newton's form: `t * (first + (t - 1) * (second + (t + last_length) * third))`.
/// At `t` = 0 it is 0.
#[derive(Clone, Copy, Debug)]
struct NewtonPolynomial {
    /// The first divided difference.
    first: DVec3,
    /// The second one; 0 for a straight line.
    second: DVec3,
    /// The third one; 0 for a parabola.
    third: DVec3,
    /// The length of the last frame: the third point is at `t = -last_length`.
    last_length: f64,
}

/// From this share of the frame on the pose is that of its end.
pub(crate) const END: f64 = 1.0 - 1e-6;

/// The pose at the start of an earlier frame, and the length of that frame divided by the length of this one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EarlierFrame {
    pub(crate) head: Pose,
    pub(crate) length: f64,
}

impl HeadPath {
    /// The path from `from` to `to`. `before` are the last frame and the one before it.
    pub(crate) fn new(before: [Option<EarlierFrame>; 2], from: Pose, to: Pose) -> Self {
        let polynomial = |of: &dyn Fn(&Pose) -> DVec3| {
            NewtonPolynomial::new(before.map(|before| before.map(|before| (of(&before.head), before.length))), of(&to))
        };
        Self {
            from,
            to,
            translation: polynomial(&|pose| pose.translation.as_dvec3() - from.translation.as_dvec3()),
            rotation: polynomial(&|pose| rotation_vector(&from, pose)),
        }
    }

    /// The pose at a share `t` of the frame. At the end it is exactly `to`. If `from` and `to` are equal the head does not
    /// move, whatever it did before.
    pub(crate) fn at(&self, t: f64) -> Pose {
        if self.from == self.to || t >= END {
            return self.to;
        }
        let turn = DQuat::from_scaled_axis(self.rotation.at(t));
        Pose {
            rotation: (turn * self.from.rotation.as_dquat()).normalize().as_quat(),
            translation: (self.from.translation.as_dvec3() + self.translation.at(t)).as_vec3(),
        }
    }
}

impl NewtonPolynomial {
    /// Through 0 at `t` = 0, through `end` at 1, and through the points of `before`: the first is its length before 0, the
    /// second its length before the first.
    fn new(before: [Option<(DVec3, f64)>; 2], end: DVec3) -> Self {
        let second_difference = |point: DVec3, time: f64| (point + time * end) / (time * (time + 1.0));
        let [Some((last, last_length)), earlier] = before else {
            return Self { first: end, second: DVec3::ZERO, third: DVec3::ZERO, last_length: 0.0 };
        };
        let second = second_difference(last, last_length);
        let third = earlier.map(|(point, length)| (second - second_difference(point, last_length + length)) / length);
        Self { first: end, second, third: third.unwrap_or(DVec3::ZERO), last_length }
    }

    fn at(&self, t: f64) -> DVec3 {
        t * (self.first + (t - 1.0) * (self.second + (t + self.last_length) * self.third))
    }
}

/// How far the path leads away from the straight line at a share `t` of the frame: that much of the way from its start to its end, to the
/// start of the last frame, and to that of the frame before it. `before` are the lengths of these two frames over that of this one.
pub(crate) fn bend(before: [Option<f64>; 2], t: f64) -> DVec3 {
    // What a path makes of three points on three axes is what it makes of each.
    let [last, earlier] = before;
    let before = [last.map(|length| (DVec3::Y, length)), earlier.map(|length| (DVec3::Z, length))];
    NewtonPolynomial::new(before, DVec3::X).at(t) - t * DVec3::X
}

/// The rotation from one pose to another as axis times angle, in the direction with the smaller angle.
fn rotation_vector(from: &Pose, to: &Pose) -> DVec3 {
    let turn = (to.rotation.as_dquat() * from.rotation.as_dquat().inverse()).normalize();
    if turn.w < 0.0 { -turn } else { turn }.to_scaled_axis()
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::*;

    fn pose(turn: f64, shift: f64) -> Pose {
        Pose {
            rotation: Quat::from_rotation_z(0.2) * Quat::from_rotation_y(turn as f32),
            translation: Vec3::new(1.0, shift as f32, -2.0),
        }
    }

    /// How far a path is from the true motion within a frame, in radians and units.
    fn errors(path: &HeadPath, truth: impl Fn(f64) -> Pose) -> (f32, f32) {
        let at = |i: u32| {
            let (is, should_be) = (path.at(f64::from(i) / 16.0), truth(f64::from(i) / 16.0));
            (is.rotation.angle_between(should_be.rotation), is.translation.distance(should_be.translation))
        };
        (0..=16).map(at).fold((0.0, 0.0), |most, error| (most.0.max(error.0), most.1.max(error.1)))
    }

    #[test]
    fn an_even_acceleration_is_followed_whatever_the_last_frame_was() {
        let truth = |t: f64| pose(0.3 * t + 0.1 * t * t, 0.2 * t - 0.3 * t * t);
        for length in [0.5, 1.0, 2.0] {
            for more in [None, Some(0.5), Some(1.0), Some(2.0)] {
                let before = EarlierFrame { head: truth(-length), length };
                let earlier = more.map(|more| EarlierFrame { head: truth(-length - more), length: more });
                let path = HeadPath::new([Some(before), earlier], truth(0.0), truth(1.0));
                let (angle, distance) = errors(&path, truth);
                assert!(angle < 2e-3 && distance < 1e-6, "{angle} {distance}");
                assert_eq!(path.at(1.0), truth(1.0));
            }
        }
    }

    #[test]
    fn a_shake_at_ten_frames_a_period_is_followed_seven_times_as_closely_as_by_lines() {
        let truth = |t: f64| pose(0.0, (0.2 * std::f64::consts::PI * t).sin());
        let largest = |known: usize| {
            let frame = |start: f64| {
                let at = |frame: usize| EarlierFrame { head: truth(start - frame as f64), length: 1.0 };
                let before = [1, 2].map(|frame| Some(at(frame)).filter(|_| frame <= known));
                let path = HeadPath::new(before, truth(start), truth(start + 1.0));
                errors(&path, |t| truth(start + t)).1
            };
            (0..10).map(f64::from).map(|start| frame(start + 0.5)).fold(0.0, f32::max)
        };
        let [line, parabola, cubic] = [0, 1, 2].map(largest);
        assert!(line > 0.045 && parabola < 0.016 && cubic < 0.0065, "{line} {parabola} {cubic}");
    }

    #[test]
    fn rest_is_rest_and_a_stop_or_a_start_goes_little_astray() {
        let before = |shifts: [f64; 2]| shifts.map(|shift| Some(EarlierFrame { head: pose(0.0, shift), length: 1.0 }));
        let rest = HeadPath::new(before([-1.0, -2.0]), pose(0.0, 0.0), pose(0.0, 0.0));
        assert_eq!(rest.at(0.3), pose(0.0, 0.0));
        let almost = pose(0.0, 1e-6);
        let (_, overshoot) = errors(&HeadPath::new(before([-1.0, -2.0]), pose(0.0, 0.0), almost), |_| almost);
        assert!((0.18..0.1926).contains(&overshoot), "{overshoot}");
        let start = HeadPath::new(before([0.0, 0.0]), pose(0.0, 0.0), pose(0.0, 1.0));
        let heights: Vec<f32> = (0..=16).map(|i| start.at(f64::from(i) / 16.0).translation.y).collect();
        assert!(heights.is_sorted() && heights[0] == 0.0 && heights[16] == 1.0, "{heights:?}");
    }

    #[test]
    fn quaternions_of_either_sign_are_the_same_rotation() {
        let (from, to) = (pose(0.0, 0.0), pose(0.4, 0.0));
        let negative = Pose { rotation: -to.rotation, ..to };
        let (angle, _) = errors(&HeadPath::new([None; 2], from, negative), |t| pose(0.4 * t, 0.0));
        assert!(angle < 2e-3, "{angle}");
    }
}
