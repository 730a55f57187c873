//! One round of Newton's method: elimination from the tip to the root, and back.

use glam::{DMat3, DQuat, DVec3};

use super::joint::{Joint, Stiffness};
use super::{AT_ONCE, Motion, Rod, RodRest, RodStep, outer};

/// How stiff the spring is that holds a tip: its stiffness times the square of the sub-step, over the mass that it holds, see
/// [`RodRest::tip_mass`]; in sub-steps shorter than [`AT_ONCE`], as stiff a spring as in those.
const HOLD: f64 = 1e4;
/// The longest rotation of an edge in a round, rad.
const LONGEST_TURN: f64 = 1.5;
/// The same of a strand that touches something: what it touches is another surface after a longer one.
const TOUCHING_TURN: f64 = 0.3;

/// What holds an edge against rolling about itself is never less than this share of the torque of its joint.
const COUPLED: f64 = 0.1;
/// What holds an edge against a rotation about itself is never less than this share of all that holds it.
const LEAST_TWIST: f64 = 1e-6;

/// What is left of an edge after the elimination: `turn = free + by_parent * turn of the parent - by_place * displacement of the
/// vertex before it`.
#[derive(Clone, Copy, Debug, Default)]
struct Eliminated {
    free: DVec3,
    by_parent: DMat3,
    by_place: DMat3,
}

/// Half of a quadratic function of the displacement of a vertex and of the rotation of the edge before it: what all that hangs on
/// them wants.
#[derive(Clone, Copy, Debug)]
struct Beyond {
    place: DMat3,
    /// Displacement times rotation.
    mixed: DMat3,
    turn: DMat3,
    force: DVec3,
    torque: DVec3,
    /// The sum of the forces alone.
    pull: DVec3,
    /// Whether anything is touched.
    touches: bool,
}

/// A round; gives the longest rotation of an edge, rad. Positions are left to be placed anew.
pub(super) fn round(motion: &Motion, rod: &mut Rod) -> f64 {
    let rest = motion.rest;
    let edges = rod.frames.len();
    let mut eliminated = vec![Eliminated::default(); edges];
    let mut beyond = at_tip(motion, rod);
    for edge in (rest.held..edges).rev() {
        eliminated[edge] = eliminate(motion, rod, edge, &mut beyond);
    }
    rod.is_touching = beyond.touches;
    let most = if beyond.touches { TOUCHING_TURN } else { LONGEST_TURN };
    let (mut moved, mut parent, mut longest) = (DVec3::ZERO, DVec3::ZERO, 0.0_f64);
    for (edge, left) in eliminated.iter().enumerate().skip(rest.held) {
        let Eliminated { free, by_parent, by_place } = *left;
        let turn = (free + by_parent * parent - by_place * moved).clamp_length_max(most);
        longest = longest.max(turn.length());
        let along = rod.frames[edge] * DVec3::Z;
        rod.rolls[edge] += turn.dot(along);
        moved += turn.cross(along) * rest.lengths[edge];
        rod.frames[edge] = (DQuat::from_scaled_axis(turn) * rod.frames[edge]).normalize();
        parent = turn;
    }
    longest
}

/// What the tip wants, with what holds it: a stiff spring and the force that it has come to, which takes the error of the spring
/// away in time (the augmented Lagrangian of Hestenes 1969 and Powell 1969).
fn at_tip(motion: &Motion, rod: &Rod) -> Beyond {
    let (rest, step, last) = (motion.rest, motion.step, rod.frames.len() - 1);
    let (mut place, mut force) = motion.inertia(last + 1, rod.positions[last + 1]);
    let (mut turn, mut torque) = (DMat3::ZERO, DVec3::ZERO);
    // The force that the tip has come to is held with, not that of the spring, which changes its sign from round to round.
    let pull = force + rod.holding;
    if let Some(hold) = step.tip {
        let spring = hold_stiffness(step, rest);
        place += spring * DMat3::IDENTITY;
        force += rod.holding + spring * (hold.place - rod.positions[last + 1]);
        if let Some(frame) = hold.frame {
            let bending = step.bending * rest.stiffening / rest.spans[last] * motion.length * motion.length;
            let stiffness = Stiffness { bending: 2.0 * bending, twist_ratio: step.twist_ratio, lag: 0.0 };
            let joint = Joint::new(rod.frames[last], DQuat::IDENTITY, frame);
            torque = -joint.torque(&stiffness, DVec3::ZERO);
            turn = joint.stiffness(&stiffness);
        }
    }
    Beyond { place, mixed: DMat3::ZERO, turn, force, torque, pull, touches: false }
}

/// The stiffness of the spring that holds a tip, times the square of the sub-step.
pub(super) fn hold_stiffness(step: &RodStep, rest: &RodRest) -> f64 {
    HOLD * (step.length / AT_ONCE).min(1.0).powi(2) * rest.tip_mass()
}

/// Takes an edge out of the system, and gives the vertex before it and its parent what the edge and all beyond want of them.
fn eliminate(motion: &Motion, rod: &Rod, edge: usize, beyond: &mut Beyond) -> Eliminated {
    let (rest, step) = (motion.rest, motion.step);
    let length = rest.lengths[edge];
    let along = rod.frames[edge] * DVec3::Z;
    // The vertex after the edge moves by the one before it and `arm * turn`.
    let arm = -length * cross_matrix(along);
    let contacts = motion.contacts(rod, edge);
    let mixed = beyond.mixed + (beyond.place + contacts.mixed) * arm;
    let half = arm.transpose() * beyond.mixed;
    let mut turn = beyond.turn + half + half.transpose() + arm.transpose() * (beyond.place + contacts.turn) * arm;
    let mut torque = beyond.torque + arm.transpose() * (beyond.force + contacts.torque);
    let across = DMat3::IDENTITY - outer(along, along);
    beyond.pull += contacts.pull;
    // Of the second derivative of a turn only what holds it: tension pulls an edge straight, pressure would let it fall.
    turn += length * along.dot(beyond.pull).max(0.0) * across;
    let correction = rest.mass_correction();
    turn -= correction * length.powi(3) / 6.0 * across;
    let lag = (motion.free(edge + 1) - motion.free(edge)) - (rod.positions[edge + 1] - rod.positions[edge]);
    torque -= correction * length / 6.0 * arm.transpose() * lag;

    let parent = if edge == 0 { step.root } else { rod.frames[edge - 1] };
    let joint = Joint::new(parent, rest.joints[edge], rod.frames[edge]);
    let square = motion.length * motion.length;
    let bending = step.bending * rest.stiffening / rest.spans[edge] * square;
    let past = motion.past_strains[edge];
    let lag = joint.lag(step.damping / motion.length, past);
    let stiffness = Stiffness { bending, twist_ratio: step.twist_ratio, lag };
    let own = joint.torque(&stiffness, past);
    let spring = joint.stiffness(&stiffness);

    // Where twist is all but free, f32 would know nothing of what is left of it beside the inertia.
    let held = turn + spring;
    turn += LEAST_TWIST * (held.x_axis.x + held.y_axis.y + held.z_axis.z) * outer(along, along);
    // The torque of a joint turns with its edges. One that is bent less than it wants holds them against rolling about themselves, which turns its bend out of
    // the plane that it wants; and any couples their rolls with what moves them aside. Its spring knows nothing of that: without the first, rounds move away from
    // their end where joints want to be bent more than twice as much as they are, as those do that make up for sag; without the second, one round a sub-step
    // takes too little of what holds a strand that stands against gravity, and it leaves its rest within seconds.
    let before = if edge == 0 { along } else { parent * DVec3::Z };
    let against_roll = (0.5 * own.dot(before.cross(along))).max(COUPLED * own.length());
    turn += against_roll * outer(along, along);
    let inverse = (turn + spring).inverse();
    let by_parent = inverse * spring;
    let by_place = inverse * mixed.transpose();
    let free = inverse * (torque + own);
    let (mass, force) = motion.inertia(edge, rod.positions[edge]);
    *beyond = Beyond {
        place: symmetric(beyond.place + contacts.place - mixed * by_place) + mass,
        mixed: mixed * by_parent,
        turn: symmetric(turn * by_parent) + against_roll * outer(before, before),
        force: beyond.force + contacts.force - mixed * free + force,
        // Equal to `spring * inverse * (torque + own) - own`, without the difference of two large numbers.
        torque: by_parent.transpose() * torque - turn * (inverse * own),
        pull: beyond.pull + force,
        touches: beyond.touches || contacts.touches,
    };
    Eliminated { free, by_parent, by_place }
}

/// The matrix of `v x`.
fn cross_matrix(v: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, v.z, -v.y), DVec3::new(-v.z, 0.0, v.x), DVec3::new(v.y, -v.x, 0.0))
}

fn symmetric(m: DMat3) -> DMat3 {
    (m + m.transpose()) * 0.5
}
