// The joint between two edges of a rod: how far it is bent and twisted, and the torque of that.

import package::symmetric::{Symmetric, outer, scaled_identity, sum};
import package::vector::{after, rotate};

/// A strain that changes by more than this within a sub-step has no rate: the joint has flipped over.
const FLIP: f32 = 1.0;
/// Twist is held at least so many times as stiffly as the joint is bent, in units of its bending stiffness: the torque of a bent joint turns with
/// the edges, which couples their rolls with what moves them aside. Where twist is softer than that, rounds go away from their end.
const HELD_TWIST: f32 = 0.3;

/// A joint in a pose.
struct Joint {
    /// The parent's frame, turned by half of the rest rotation of the joint.
    middle: vec4<f32>,
    /// The child's frame, turned back by the other half.
    back: vec4<f32>,
    /// What that one is turned from there; the shorter way.
    turn: vec4<f32>,
    /// Two components of bending and one of twist.
    strain: vec3<f32>,
}

/// How stiff a joint is: its bending stiffness, what twist has of it, and the damping time over the length of the sub-step.
struct Stiffness { bending: f32, twist_ratio: f32, lag: f32 }

/// The strain of a turn over its axis part. Its energy has no pole and no kink at a half turn.
fn slope(w: f32) -> f32 {
    return 4.0 / (1.0 + w * w);
}

/// The child's frame, turned back by half of the rest rotation.
fn turned_back(child: vec4<f32>, half_turn: vec4<f32>) -> vec4<f32> {
    return after(child, vec4(-half_turn.xyz, half_turn.w));
}

/// `half_turn` is half of the rest rotation from the parent to the child.
fn joint_between(parent: vec4<f32>, half_turn: vec4<f32>, child: vec4<f32>) -> Joint {
    let middle = after(parent, half_turn);
    let back = turned_back(child, half_turn);
    let turn = after(vec4(-middle.xyz, middle.w), back);
    let shorter = select(turn, -turn, turn.w < 0.0);
    return Joint(middle, back, shorter, slope(shorter.w) * shorter.xyz);
}

/// The lag of the moments of a joint, which is 0 where it has flipped over since `past`. Torque and stiffness have to have the same one.
fn lag_of(joint: Joint, lag: f32, past: vec3<f32>) -> f32 {
    let rate = joint.strain - past;
    return select(lag, 0.0, dot(rate, rate) > FLIP * FLIP);
}

/// The torque on the child, on the axes of the world; the parent gets the opposite. `past` is the strain that the rate of bending is
/// measured from.
fn torque_of(joint: Joint, stiffness: Stiffness, past: vec3<f32>) -> vec3<f32> {
    let weights = stiffness.bending * vec3(1.0, 1.0, stiffness.twist_ratio);
    let moment = weights * (joint.strain + stiffness.lag * (joint.strain - past));
    let v = joint.turn.xyz;
    let w = joint.turn.w;
    let s = slope(w);
    let torque = 0.5 * s * (w * moment + cross(v, moment)) + 0.25 * s * s * w * dot(v, moment) * v;
    return rotate(joint.middle, -torque);
}

/// What stands for the derivative of the torque by a rotation between the edges: exact for small strains, too stiff for large ones.
/// It is `bending` times a rotation across the axis, and `bending * twist_ratio` times one about it.
struct Spring { bending: f32, twist_ratio: f32, axis: vec3<f32> }

fn spring_of(joint: Joint, stiffness: Stiffness) -> Spring {
    let stiffer = 0.5 * slope(joint.turn.w);
    let bending = stiffer * stiffer * stiffer * (1.0 + stiffness.lag) * stiffness.bending;
    let twist_ratio = max(stiffness.twist_ratio, HELD_TWIST * length(joint.strain.xy));
    return Spring(bending, twist_ratio, twist_axis(joint.middle, joint.back));
}

/// The axis that twist is stiff about: halfway from one frame to the other, the shorter way. With that of either of them a bent joint
/// whose twist is much stiffer or softer than its bending is held several times too weakly, and what the rounds find swings to and fro.
fn twist_axis(middle: vec4<f32>, back: vec4<f32>) -> vec3<f32> {
    let halfway = normalize(middle + select(back, -back, dot(middle, back) < 0.0));
    return rotate(halfway, vec3(0.0, 0.0, 1.0));
}

fn torque_by(spring: Spring, turn: vec3<f32>) -> vec3<f32> {
    return spring.bending * (turn + (spring.twist_ratio - 1.0) * dot(spring.axis, turn) * spring.axis);
}

fn stiffness_of(spring: Spring) -> Symmetric {
    let twist = outer(spring.bending * (spring.twist_ratio - 1.0), spring.axis);
    return sum(scaled_identity(spring.bending), twist);
}

/// The stiffness times a matrix,
fn spring_by(spring: Spring, m: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3(torque_by(spring, m[0]), torque_by(spring, m[1]), torque_by(spring, m[2]));
}

/// and a matrix times the stiffness.
fn by_spring(m: mat3x3<f32>, spring: Spring) -> mat3x3<f32> {
    let twist = (spring.twist_ratio - 1.0) * (m * spring.axis);
    let t = spring.axis;
    return mat3x3(
        spring.bending * (m[0] + t.x * twist),
        spring.bending * (m[1] + t.y * twist),
        spring.bending * (m[2] + t.z * twist),
    );
}
