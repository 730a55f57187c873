// Local shape constraints: each edge wants the angle to the edge before it that it has in the rest pose, and the first edge
// that to its root. From the root to the tip, several times, each iteration one edge behind the one before it.

import package::constants::LOCAL;
import package::step::step;
import package::vector::{NO_LENGTH, across, after, rotate};

/// Iteration `k` is at the edge between `vertices[k + 1]` and `vertices[k]`. Vertices are relative to the root, with their inverse
/// mass.
struct Shaping {
    /// The vertex that comes next, and its `edges` entry.
    entered: vec4<f32>,
    entered_edge: vec4<f32>,
    /// At vertex `t` of the walk `vertices[k]` is vertex `t - k`.
    vertices: array<vec4<f32>, LOCAL + 1u>,
    /// The edge to each from its parent in the rest pose: a unit vector, or 0 where it has no direction, and its length.
    edges: array<vec4<f32>, LOCAL + 1u>,
    /// What the strand has turned up to the edge that an iteration is at. It starts as the root does, and each edge adds the
    /// smallest turn that explains it: so a curl that is turned as a whole is still the same curl.
    frames: array<vec4<f32>, LOCAL + 1u>,
}

/// Takes in vertex `t`: one edge of each iteration. Afterwards all are done with `vertices[LOCAL]`.
fn shaped(shaping: ptr<function, Shaping>, t: u32) {
    for (var k = LOCAL; k > 0u; k--) {
        (*shaping).vertices[k] = (*shaping).vertices[k - 1u];
        (*shaping).edges[k] = (*shaping).edges[k - 1u];
    }
    (*shaping).vertices[0] = (*shaping).entered;
    (*shaping).edges[0] = (*shaping).entered_edge;
    for (var k = 0u; k < LOCAL; k++) {
        if (t > k && t < step.vertices + k) { bend(shaping, k); }
    }
}

/// Both ends of an edge are moved by half of its share of the distance to the rest shape.
fn bend(shaping: ptr<function, Shaping>, k: u32) {
    var parent = (*shaping).vertices[k + 1u];
    var child = (*shaping).vertices[k];
    let frame = (*shaping).frames[k];
    let rest_edge = (*shaping).edges[k];
    let heading = rotate(frame, rest_edge.xyz);
    let correction = 0.5 * step.local_stiffness * (rest_edge.w * heading - (child.xyz - parent.xyz));
    parent -= vec4(select(vec3(0.0), correction, parent.w > 0.0), 0.0);
    child += vec4(select(vec3(0.0), correction, child.w > 0.0), 0.0);
    (*shaping).vertices[k + 1u] = parent;
    (*shaping).vertices[k] = child;

    // An edge without a length turns nothing.
    let edge = child.xyz - parent.xyz;
    let squared = dot(edge, edge);
    if (rest_edge.w * rest_edge.w > NO_LENGTH && squared > NO_LENGTH) {
        (*shaping).frames[k] = turned_on(frame, heading, edge * inverseSqrt(squared));
    }
}

/// Below this `1 + cos` of the angle between two directions is short of digits.
const FOLDED: f32 = 0.3;

/// A unit quaternion, then the smallest turn from one unit vector to another. Its length is kept at 1 by what is known before the
/// turn is: the walk along the strand waits for this. Between vectors that are all but opposite that of the turn is measured: there `c`
/// is mostly rounding, and a length that followed from it would grow from fold to fold.
fn turned_on(frame: vec4<f32>, one: vec3<f32>, other: vec3<f32>) -> vec4<f32> {
    // Near 1 a step of Newton's method, which rounds less; far from it that step diverges.
    let squared = dot(frame, frame);
    let to_unit = select(inverseSqrt(squared), 1.5 - 0.5 * squared, abs(squared - 1.0) < 0.01);
    let c = 1.0 + dot(one, other);
    if (c < 1e-6) { return after(vec4(across(one), 0.0), frame); }
    let arc = vec4(cross(one, other), c);
    return after(arc * (inverseSqrt(select(2.0 * c, dot(arc, arc), c < FOLDED)) * to_unit), frame);
}
