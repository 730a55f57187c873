// Velocity shock propagation, Verlet integration with damping and gravity, and the pull towards the global shape. Also what brings
// a vertex from the centre of the last sub-step to that of this one.

import package::root::{Root, carried, most_carried, shape_of};
import package::step::step;
import package::vector::rotate;

/// A vertex before the constraints, and where it was one sub-step ago.
struct Free { position: vec3<f32>, past: vec3<f32> }

/// Moves a vertex freely from `last`; it was at `past` before. Both are relative to the centre of the last sub-step.
fn integrated(root: Root, last: vec3<f32>, past: vec3<f32>, rest: vec4<f32>, vertex: u32) -> Free {
    let shape = shape_of(root, rest.xyz);
    // A pinned vertex goes where its root takes it, so its past does not matter.
    if (rest.w == 0.0) { return Free(shape, shape); }
    let here = shocked(root, last);
    let displacement = bounded(root, here, shocked_displacement(root, last - past), past);
    let moved = here + step.velocity_kept * displacement + step.gravity;
    return Free(pulled_to_shape(moved, shape, vertex), here);
}

/// A point that has made its share of the root's motion at once, so that a quick head does not leave its hair behind and the
/// length constraints need not catch up. Position and past make it alike, and before the integration: the pull towards the
/// global shape would else count this share a second time. `last` is relative to the centre of the last sub-step.
fn shocked(root: Root, last: vec3<f32>) -> vec3<f32> {
    let here = last - step.center_displacement;
    return here + step.shock * (carried(root, last) - here);
}

/// The displacement between two points that have made their share of the root's motion. From their displacement before it,
/// since the difference of two rounded points would lose more.
fn shocked_displacement(root: Root, last: vec3<f32>) -> vec3<f32> {
    return last + step.shock * (rotate(root.turn, last) - last);
}

/// The displacement, no longer than `max_displacement` relative to the head: a passenger's hair is not held back by the
/// speed of the car. The head's motion counts without the share that the shock has made already.
fn bounded(root: Root, here: vec3<f32>, displacement: vec3<f32>, past: vec3<f32>) -> vec3<f32> {
    if (is_slow(root, here, displacement)) { return displacement; }
    let before = shocked(root, past);
    let remaining = (1.0 - step.shock) * (carried(root, before + step.center_displacement) - before);
    let relative = displacement - remaining;
    let squared = dot(relative, relative);
    if (squared <= step.max_displacement * step.max_displacement) { return displacement; }
    return remaining + relative * (step.max_displacement * inverseSqrt(squared));
}

/// Whether a displacement is so small that it needs no bound, wherever the head's motion goes. Most are; then it is not asked where that is.
fn is_slow(root: Root, here: vec3<f32>, displacement: vec3<f32>) -> bool {
    let motion = (1.0 - step.shock) * most_carried(root);
    // Squares of sums are no more than so many times the sums of squares.
    let squared = dot(displacement, displacement);
    let by_head = motion.x * motion.x * (dot(here, here) + squared) + motion.y * motion.y;
    return 2.0 * squared + 6.0 * by_head < step.max_displacement * step.max_displacement;
}

/// A vertex after the pull towards where its root takes the rest pose, if it is within the range.
fn pulled_to_shape(point: vec3<f32>, shape: vec3<f32>, vertex: u32) -> vec3<f32> {
    @if(!global_shape) { return point; }
    @if(global_shape) {
        if (f32(vertex) >= step.global_range * f32(step.vertices)) { return point; }
        return point + step.global_stiffness * (shape - point);
    }
}
