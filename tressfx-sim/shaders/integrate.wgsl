// Velocity shock propagation, Verlet integration with damping and gravity, and the pull towards the global shape. Also what brings
// a vertex from the centre of the last sub-step to that of this one.

import package::root::{Root, carried, most_carried, shape_of};
import package::step::step;
import package::vector::{matrix_of, moved_by};

/// A vertex before the constraints, and where it was one sub-step ago.
struct Free { position: vec3<f32>, past: vec3<f32> }

/// How its root moves a strand. As matrices: each vertex is turned three times, and a matrix takes half as long as a quaternion.
struct Carrier {
    root: Root,
    /// Where a point of the rest pose is taken, together with `shape_place`.
    shape: mat3x3<f32>,
    shape_place: vec3<f32>,
    /// What makes its share of the root's motion at once, so that a quick head does not leave its hair behind and the length
    /// constraints need not catch up: a displacement changes by `shock` times itself, a point by `shift` more. Position and past make it
    /// alike, and before the integration: the pull towards the global shape would else count this share a second time.
    shock: mat3x3<f32>,
    shift: vec3<f32>,
    /// The rest of the root's motion moves no point by more than the first of these times its distance from the centre, and the
    /// second.
    most_left: vec2<f32>,
}

fn carrier_of(root: Root) -> Carrier {
    let shock = step.shock * moved_by(root.turn);
    let left = 1.0 - step.shock;
    let shift = step.shock * carried(root, vec3(0.0)) - left * step.center_displacement;
    return Carrier(root, matrix_of(root.rotation), shape_of(root, vec3(0.0)), shock, shift, left * most_carried(root));
}

/// Moves a vertex freely from `last`; it was at `past` before. Both are relative to the centre of the last sub-step. Only the
/// bound of the speed has a branch: a branch costs a walk more than what it leaves out.
fn integrated(carrier: Carrier, last: vec3<f32>, past: vec3<f32>, rest: vec4<f32>, vertex: u32) -> Free {
    let shape = carrier.shape * rest.xyz + carrier.shape_place;
    let here = shocked(carrier, last);
    // The difference of two points that have been rounded again would lose more than this.
    let before = last - past;
    let displacement = bounded(carrier, here, before + carrier.shock * before, past);
    let moved = here + step.velocity_kept * displacement + step.gravity;
    // A pinned vertex goes where its root takes it, so its past does not matter.
    let is_pinned = rest.w == 0.0;
    return Free(select(pulled_to_shape(moved, shape, vertex), shape, is_pinned), select(here, shape, is_pinned));
}

/// A point that has made its share of the root's motion; `last` is relative to the centre of the last sub-step.
fn shocked(carrier: Carrier, last: vec3<f32>) -> vec3<f32> {
    return last + (carrier.shock * last + carrier.shift);
}

/// The displacement, no longer than `max_displacement` relative to the head: a passenger's hair is not held back by the
/// speed of the car. The head's motion counts without the share that the shock has made already.
fn bounded(carrier: Carrier, here: vec3<f32>, displacement: vec3<f32>, past: vec3<f32>) -> vec3<f32> {
    if (is_slow(carrier, here, displacement)) { return displacement; }
    let before = shocked(carrier, past);
    let remaining = (1.0 - step.shock) * (carried(carrier.root, before + step.center_displacement) - before);
    let relative = displacement - remaining;
    let squared = dot(relative, relative);
    if (squared <= step.max_displacement * step.max_displacement) { return displacement; }
    return remaining + relative * (step.max_displacement * inverseSqrt(squared));
}

/// Whether a displacement is so small that it needs no bound, wherever the head's motion goes. Most are; then it is not asked where that is.
fn is_slow(carrier: Carrier, here: vec3<f32>, displacement: vec3<f32>) -> bool {
    let left = carrier.most_left;
    // Squares of sums are no more than so many times the sums of squares.
    let squared = dot(displacement, displacement);
    let by_head = left.x * left.x * (dot(here, here) + squared) + left.y * left.y;
    return 2.0 * squared + 6.0 * by_head < step.max_displacement * step.max_displacement;
}

/// A vertex after the pull towards where its root takes the rest pose, if it is within the range.
fn pulled_to_shape(point: vec3<f32>, shape: vec3<f32>, vertex: u32) -> vec3<f32> {
    @if(!global_shape) { return point; }
    @if(global_shape) {
        let is_within = f32(vertex) < step.global_range * f32(step.vertices);
        return point + select(0.0, step.global_stiffness, is_within) * (shape - point);
    }
}
