// Length constraints: the ends of an edge are moved to its rest length. In each iteration first all even edges, then all odd ones,
// as TressFX does it with a thread an edge. In a walk along the strand each of these halves goes one edge behind the one before it.

import package::constants::LENGTHS;
import package::step::step;
import package::vector::NO_LENGTH;

/// Half `j` is at the edge between `vertices[j + 1]` and `vertices[j]`. At vertex `t` of the walk `vertices[j]` is vertex `t - j`,
/// relative to the root, with its inverse mass, and `lengths[j]` its rest length from its parent.
struct Stretching { vertices: array<vec4<f32>, 2u * LENGTHS + 1u>, lengths: array<f32, 2u * LENGTHS + 1u> }

/// Takes in vertex `t`, at `vertex`, `length` from its parent. Afterwards all are done with the last of `vertices`.
fn stretched(stretching: ptr<function, Stretching>, vertex: vec4<f32>, length: f32, t: u32) {
    for (var j = 2u * LENGTHS; j > 0u; j--) {
        (*stretching).vertices[j] = (*stretching).vertices[j - 1u];
        (*stretching).lengths[j] = (*stretching).lengths[j - 1u];
    }
    (*stretching).vertices[0] = vertex;
    (*stretching).lengths[0] = length;
    // The edge to an odd vertex is even, and an even half is at it.
    if (t % 2u == 0u) { return; }
    for (var j = 0u; j < 2u * LENGTHS; j++) {
        let parent = (*stretching).vertices[j + 1u];
        let child = (*stretching).vertices[j];
        let is_edge = t > j && t < step.vertices + j;
        let correction = select(vec3(0.0), correction_of(parent, child, (*stretching).lengths[j]), is_edge);
        (*stretching).vertices[j + 1u] = parent + vec4(parent.w * correction, 0.0);
        (*stretching).vertices[j] = child - vec4(child.w * correction, 0.0);
    }
}

/// What moves the ends of an edge to its rest length, for an inverse mass of 1. Without branches, and with nothing
/// between positions and result that depends on the masses alone: the walk along the strand waits for this.
fn correction_of(a: vec4<f32>, b: vec4<f32>, length: f32) -> vec3<f32> {
    let mass = a.w + b.w;
    let share = select(0.0, 1.0 / mass, mass > 0.0);
    let edge = b.xyz - a.xyz;
    let squared = dot(edge, edge);
    let stretch = share - share * length * inverseSqrt(max(squared, NO_LENGTH));
    return edge * select(0.0, stretch, squared > NO_LENGTH);
}
