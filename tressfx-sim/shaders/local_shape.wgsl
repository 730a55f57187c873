// Local shape constraints: each edge wants the angle to the edge before it that it has in the rest pose, and the first edge
// that to its root. From the root to the tip, several times, each iteration one edge behind the one before it.

import package::constants::LOCAL;
import package::step::step;
import package::vector::{NO_LENGTH, after, rotate};

/// An edge of the rest pose, from the parent; its length and one over that, both 0 where it has no direction.
struct RestEdge { along: vec3<f32>, length: f32, inverse_length: f32 }

/// Iteration `k` is at the edge between `vertices[k + 1]` and `vertices[k]`. Vertices are relative to the root, with their inverse
/// mass.
struct Shaping {
    /// The vertex that comes next, and its edge.
    entered: vec4<f32>,
    entered_edge: RestEdge,
    /// At vertex `t` of the walk `vertices[k]` is vertex `t - k`.
    vertices: array<vec4<f32>, LOCAL + 1u>,
    /// The edge to each from its parent.
    edges: array<RestEdge, LOCAL + 1u>,
    /// What the strand has turned up to the edge that an iteration is at. It starts as the root does, and each edge adds the
    /// smallest turn that explains it: so a curl that is turned as a whole is still the same curl.
    frames: array<vec4<f32>, LOCAL + 1u>,
}

fn rest_edge_of(along: vec3<f32>) -> RestEdge {
    let squared = dot(along, along);
    let inverse = select(0.0, inverseSqrt(squared), squared > NO_LENGTH);
    return RestEdge(along, squared * inverse, inverse);
}

/// Takes in vertex `t`: one edge of each iteration. Afterwards all are done with `vertices[LOCAL]`. There are no branches, not even
/// where the strand has no such edge: so a compiler may do one iteration while another waits.
fn shaped(shaping: ptr<function, Shaping>, t: u32) {
    for (var k = LOCAL; k > 0u; k--) {
        (*shaping).vertices[k] = (*shaping).vertices[k - 1u];
        (*shaping).edges[k] = (*shaping).edges[k - 1u];
    }
    (*shaping).vertices[0] = (*shaping).entered;
    (*shaping).edges[0] = (*shaping).entered_edge;
    for (var k = 0u; k < LOCAL; k++) {
        bend(shaping, k, t > k && t < step.vertices + k);
    }
}

/// Both ends of an edge are moved by half of its share of the distance to the rest shape.
fn bend(shaping: ptr<function, Shaping>, k: u32, is_edge: bool) {
    var parent = (*shaping).vertices[k + 1u];
    var child = (*shaping).vertices[k];
    let frame = (*shaping).frames[k];
    let rest_edge = (*shaping).edges[k];
    let heading = rotate(frame, rest_edge.along);
    let missing = heading - (child.xyz - parent.xyz);
    let share = select(0.0, 0.5 * step.local_stiffness, is_edge);
    parent -= vec4(select(0.0, share, parent.w > 0.0) * missing, 0.0);
    child += vec4(select(0.0, share, child.w > 0.0) * missing, 0.0);
    (*shaping).vertices[k + 1u] = parent;
    (*shaping).vertices[k] = child;

    // An edge without a length turns nothing.
    let edge = child.xyz - parent.xyz;
    let squared = dot(edge, edge);
    let turns = is_edge && rest_edge.inverse_length > 0.0 && squared > NO_LENGTH;
    let turned = turned_on(frame, heading, edge, rest_edge.inverse_length * inverseSqrt(squared));
    (*shaping).frames[k] = select(frame, turned, turns);
}

/// Below this `1 + cos` of the angle between two directions is short of digits.
const FOLDED: f32 = 0.3;

/// A unit quaternion, then the smallest turn from the direction of one vector to that of another; `inverse` is one over the product of
/// their lengths. Opposite vectors are joined by a half turn. Its length is kept at 1 by what is known before the turn is: the walk
/// along the strand waits for this. Between vectors that are all but opposite that of the turn is measured: there `c` is mostly
/// rounding, and a length that followed from it would grow from fold to fold.
fn turned_on(frame: vec4<f32>, one: vec3<f32>, other: vec3<f32>, inverse: f32) -> vec4<f32> {
    // Near 1 a step of Newton's method, which rounds less; far from it that step diverges.
    let squared = dot(frame, frame);
    let to_unit = select(inverseSqrt(squared), 1.5 - 0.5 * squared, abs(squared - 1.0) < 0.01);
    let c = 1.0 + inverse * dot(one, other);
    let is_opposite = c < 1e-6;
    let axis = select(inverse * cross(one, other), perpendicular_to(one), is_opposite);
    let arc = vec4(axis, select(c, 0.0, is_opposite));
    return after(arc * (inverseSqrt(select(2.0 * c, dot(arc, arc), c < FOLDED)) * to_unit), frame);
}

/// A vector across another of any length, of at least 0.7 of that. What takes it makes its own unit vector, so `across` would do that twice.
fn perpendicular_to(v: vec3<f32>) -> vec3<f32> {
    return select(vec3(0.0, v.z, -v.y), vec3(-v.z, 0.0, v.x), abs(v.x) > abs(v.y));
}
