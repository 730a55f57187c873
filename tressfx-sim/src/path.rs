//! The way of the head within a frame, of which only the ends are known.

use glam::{DQuat, DVec3};
use tressfx_core::view::Pose;

/// The way from one head pose to the next: the parabola through both and the one before, or a straight line without that.
///
/// A straight line would miss an eighth of the acceleration times the square of the frame, and jerk at every frame. A head that
/// stops at once overshoots by an eighth of its last way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    from: Pose,
    to: Pose,
    translation: Parabola,
    /// Of the rotation vector from `from`.
    rotation: Parabola,
}

/// `t * way + t * (t - 1) * bend`.
#[derive(Clone, Copy, Debug)]
struct Parabola {
    way: DVec3,
    bend: DVec3,
}

/// A share of the frame that is the end of it.
const END: f64 = 1.0 - 1e-6;

/// The pose at the start of the last frame, and how long that frame was in lengths of this one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Before {
    pub(crate) head: Pose,
    pub(crate) length: f64,
}

impl Path {
    /// The way from `from` to `to`. A head that stays where it is has come to rest, whatever it did before.
    pub(crate) fn new(before: Option<Before>, from: Pose, to: Pose) -> Self {
        let before = before.filter(|_| from != to);
        let parabola = |of: &dyn Fn(&Pose) -> DVec3| {
            Parabola::new(before.map(|before| (of(&before.head), before.length)), of(&to))
        };
        Self {
            from,
            to,
            translation: parabola(&|pose| pose.translation.as_dvec3() - from.translation.as_dvec3()),
            rotation: parabola(&|pose| rotation_vector(&from, pose)),
        }
    }

    /// The pose at a share `t` of the frame. The end and a head at rest are met exactly.
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

impl Parabola {
    /// Through 0 at 0, through `way` at 1 and, with `before`, through its point at minus its length.
    fn new(before: Option<(DVec3, f64)>, way: DVec3) -> Self {
        let bend = before.map(|(point, length)| (point + length * way) / (length * (length + 1.0)));
        Self { way, bend: bend.unwrap_or(DVec3::ZERO) }
    }

    fn at(&self, t: f64) -> DVec3 {
        t * self.way + t * (t - 1.0) * self.bend
    }
}

/// Axis times angle of the shorter rotation from one pose to another.
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
    fn errors(path: &Path, truth: impl Fn(f64) -> Pose) -> (f32, f32) {
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
            let path = Path::new(Some(Before { head: truth(-length), length }), truth(0.0), truth(1.0));
            let (angle, distance) = errors(&path, truth);
            assert!(angle < 2e-3 && distance < 1e-6, "{angle} {distance}");
            assert_eq!(path.at(1.0), truth(1.0));
        }
    }

    #[test]
    fn a_shake_at_ten_frames_a_period_is_followed_three_times_as_closely_as_by_lines() {
        let truth = |t: f64| pose(0.0, (0.2 * std::f64::consts::PI * t).sin());
        let largest = |parabola: bool| {
            let frame = |start: f64| {
                let before = Before { head: truth(start - 1.0), length: 1.0 };
                let path = Path::new(Some(before).filter(|_| parabola), truth(start), truth(start + 1.0));
                errors(&path, |t| truth(start + t)).1
            };
            (0..10).map(f64::from).map(|start| frame(start + 0.5)).fold(0.0, f32::max)
        };
        let (line, parabola) = (largest(false), largest(true));
        assert!(line > 0.045 && parabola < 0.016, "{line} {parabola}");
    }

    #[test]
    fn rest_is_rest_and_a_stop_or_a_start_goes_little_astray() {
        let before = |head| Some(Before { head, length: 1.0 });
        let rest = Path::new(before(pose(0.2, -1.0)), pose(0.0, 0.0), pose(0.0, 0.0));
        assert_eq!(rest.at(0.3), pose(0.0, 0.0));
        let almost = pose(0.0, 1e-6);
        let (_, overshoot) = errors(&Path::new(before(pose(0.0, -1.0)), pose(0.0, 0.0), almost), |_| almost);
        assert!(overshoot < 0.1251, "{overshoot}");
        let start = Path::new(before(pose(0.0, 0.0)), pose(0.0, 0.0), pose(0.0, 1.0));
        let heights: Vec<f32> = (0..=16).map(|i| start.at(f64::from(i) / 16.0).translation.y).collect();
        assert!(heights.is_sorted() && heights[0] == 0.0 && heights[16] == 1.0, "{heights:?}");
    }

    #[test]
    fn quaternions_of_either_sign_are_the_same_rotation() {
        let (from, to) = (pose(0.0, 0.0), pose(0.4, 0.0));
        let negative = Pose { rotation: -to.rotation, ..to };
        let (angle, _) = errors(&Path::new(None, from, negative), |t| pose(0.4 * t, 0.0));
        assert!(angle < 2e-3, "{angle}");
    }
}
