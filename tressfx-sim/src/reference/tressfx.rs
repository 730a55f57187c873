//! `hair.sim.tressfx` in f64: the stages of the published method, one after the other over the whole strand.

mod contact;

use glam::DVec3;
use tressfx_core::shape::Capsule;

use super::Guide;
use super::field::PlacedField;
use super::roots::RootMotion;
use super::vector::{DOWN, NO_LENGTH, direction_or, position, rotate, turned};
use super::wind::wind_of;
use crate::collider::CapsuleMotion;
use crate::params::SimParams;
use crate::step::Step;

/// A sub-step of the method of TressFX, or the reset to the rest pose: positions are integrated and pulled to the global shape
/// ([`SimParams::global_stiffness`]), iterations of the local shape constraints go from the root to the tip, the wind blows,
/// iterations of the length constraints move the ends of first all even, then all odd edges, and capsules and fields push vertices out. `strand`
/// is the index of the guide, on which its wind depends.
///
/// It is what the porting guide of AMD (2013) and TressFX 4.1 describe, but for what is wrong there: velocity shock comes before the
/// pull to the global shape, which would count it a second time, and follows the root's own motion; the iterations of the local
/// shape share its stiffness, and its frames are carried along the strand as up to TressFX 4.0; wind acts on edges as they were
/// before it, and by their direction alone; a vertex that was pushed out keeps the velocity that the contact and its friction leave.
///
/// A strand that becomes non-finite goes to its rest pose, at rest; says whether it did.
pub fn tressfx(
    step: &Step,
    params: &SimParams,
    guide: &mut Guide,
    strand: u32,
    capsules: &[(Capsule, CapsuleMotion)],
    fields: &[PlacedField],
) -> bool {
    let root = guide.root(step);
    if step.reset != 0 {
        rest_pose(guide, &root);
        return false;
    }
    integrate(step, guide, &root);
    for _ in 0..params.local_iterations_of(guide.vertices() as u32) {
        local_shape(step, guide, &root);
    }
    wind(step, guide, strand);
    for _ in 0..params.length_iterations {
        [0, 1].into_iter().for_each(|first| lengths(guide, first));
    }
    contact::contacts(step, guide, &root, capsules, fields);
    let finite = guide.positions.iter().all(|point| point.is_finite());
    if !finite {
        rest_pose(guide, &root);
    }
    !finite
}

fn rest_pose(guide: &mut Guide, root: &RootMotion) {
    for i in 0..guide.vertices() {
        guide.positions[i] = root.shape(position(guide.rest[i]));
        guide.previous[i] = guide.positions[i];
    }
}

/// Velocity shock, Verlet integration with damping and gravity, and the pull to the global shape.
fn integrate(step: &Step, guide: &mut Guide, root: &RootMotion) {
    for i in 0..guide.vertices() {
        let shape = root.shape(position(guide.rest[i]));
        if guide.is_pinned(i) {
            guide.positions[i] = shape;
            guide.previous[i] = shape;
            continue;
        }
        let (here, before) = (shocked(step, root, guide.positions[i]), shocked(step, root, guide.previous[i]));
        let mut goal =
            here + f64::from(step.velocity_kept) * bounded(step, root, here - before, before) + step.gravity.as_dvec3();
        if (i as f32) < step.global_range * guide.vertices() as f32 {
            goal += f64::from(step.global_stiffness) * (shape - goal);
        }
        guide.previous[i] = here;
        guide.positions[i] = goal;
    }
}

/// A point that has made its share of the root's motion.
fn shocked(step: &Step, root: &RootMotion, last: DVec3) -> DVec3 {
    let here = last - step.center_displacement.as_dvec3();
    here + f64::from(step.shock) * (root.carried(last) - here)
}

/// The displacement, no longer than allowed relative to the head, whose motion counts without the share of the shock.
fn bounded(step: &Step, root: &RootMotion, displacement: DVec3, before: DVec3) -> DVec3 {
    let remaining =
        (1.0 - f64::from(step.shock)) * (root.carried(before + step.center_displacement.as_dvec3()) - before);
    let relative = displacement - remaining;
    let longest = f64::from(step.max_displacement);
    if relative.length_squared() <= longest * longest {
        return displacement;
    }
    remaining + relative.normalize_or_zero() * longest
}

/// One iteration of the local shape constraints. Each edge is pulled towards the angle to the edge before it that it has in the
/// rest pose; the first one to its root's.
fn local_shape(step: &Step, guide: &mut Guide, root: &RootMotion) {
    let mut frame = root.rotation;
    for i in 0..guide.vertices() - 1 {
        let goal = rotate(frame, position(guide.rest[i + 1]) - position(guide.rest[i]));
        let correction = 0.5 * f64::from(step.local_stiffness) * (goal - (guide.positions[i + 1] - guide.positions[i]));
        if !guide.is_pinned(i) {
            guide.positions[i] -= correction;
        }
        if !guide.is_pinned(i + 1) {
            guide.positions[i + 1] += correction;
        }
        let edge = guide.positions[i + 1] - guide.positions[i];
        if goal.length_squared().min(edge.length_squared()) > NO_LENGTH {
            frame = turned(frame, goal.normalize(), edge.normalize());
        }
    }
}

/// Each vertex is moved by the part of the wind that is across its edge. All edges are as they were before the wind.
fn wind(step: &Step, guide: &mut Guide, strand: u32) {
    let wind = wind_of(step, strand);
    let mut direction = DOWN;
    for i in 0..guide.vertices() {
        if let Some(next) = guide.positions.get(i + 1) {
            direction = direction_or(*next - guide.positions[i], direction);
        }
        if !guide.is_pinned(i) {
            guide.positions[i] += wind - wind.dot(direction) * direction;
        }
    }
}

/// Every second edge, from `first` on: its ends are moved to its rest length.
fn lengths(guide: &mut Guide, first: usize) {
    for i in (first..guide.vertices() - 1).step_by(2) {
        let (a, b) = (guide.inverse_mass(i), guide.inverse_mass(i + 1));
        let edge = guide.positions[i + 1] - guide.positions[i];
        if a + b == 0.0 || edge.length_squared() <= NO_LENGTH {
            continue;
        }
        let length = position(guide.rest[i]).distance(position(guide.rest[i + 1]));
        let correction = edge * ((1.0 - length / edge.length()) / (a + b));
        guide.positions[i] += a * correction;
        guide.positions[i + 1] -= b * correction;
    }
}
