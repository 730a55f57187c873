// Local shape constraints: each edge wants the angle to the edge before it that it has in the rest pose, and the first edge
// that to its root. From the root to the tip, several times. One thread a guide.

import package::grid::{GROUP, thread_index};
import package::root::root_of;
import package::step::step;
import package::vector::{NO_LENGTH, rotate, turned};

@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn local_shape(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= step.guides) { return; }
    for (var iteration = 0u; iteration < step.local_iterations; iteration++) {
        constrain(strand);
    }
}

/// Vertices that are loaded at once, into registers: with eight there are too many.
const CHUNK: u32 = 4u;

/// The edge that an iteration is at: `frame` is what the strand has turned so far. It starts as the root does, and each edge
/// adds the smallest turn that explains it: so a curl that is turned as a whole is still the same curl.
struct BentEdge { frame: vec4<f32>, here: vec4<f32>, next: vec4<f32> }

/// One iteration: each edge once, from the root to the tip.
fn constrain(strand: u32) {
    // Positions are relative to the root, see `lengths`.
    let root = positions[strand].xyz;
    let tip = step.vertices - 1u;
    var edge = BentEdge(root_of(strand).rotation, vec4(vec3(0.0), positions[strand].w), from_root(root, positions[step.strands + strand]));
    var rest_here = rest[strand].xyz;
    var rest_next = rest[step.guides + strand].xyz;
    for (var start = 0u; start < tip; start += CHUNK) {
        // Loaded before the first of these vertices is stored: loads behind a store to the same buffer would wait for it.
        var ahead: array<vec4<f32>, CHUNK>;
        var rest_ahead: array<vec3<f32>, CHUNK>;
        for (var i = 0u; i < CHUNK; i++) {
            let vertex = min(start + i + 2u, tip);
            ahead[i] = positions[vertex * step.strands + strand];
            rest_ahead[i] = rest[vertex * step.guides + strand].xyz;
        }
        for (var i = 0u; i < CHUNK; i++) {
            if (start + i >= tip) { break; }
            edge = bent(edge, rest_next - rest_here);
            positions[(start + i) * step.strands + strand] = from_root(-root, edge.here);
            edge.here = edge.next;
            edge.next = from_root(root, ahead[i]);
            rest_here = rest_next;
            rest_next = rest_ahead[i];
        }
    }
    positions[tip * step.strands + strand] = from_root(-root, edge.here);
}

/// An edge that has been moved by its share of the distance to its rest pose, and the frame behind it.
fn bent(edge: BentEdge, rest_edge: vec3<f32>) -> BentEdge {
    var bent = edge;
    let goal = rotate(edge.frame, rest_edge);
    let mass = edge.here.w + edge.next.w;
    let share = select(step.local_stiffness / mass, 0.0, mass == 0.0);
    let correction = share * (goal - (edge.next.xyz - edge.here.xyz));
    bent.here -= vec4(edge.here.w * correction, 0.0);
    bent.next += vec4(edge.next.w * correction, 0.0);

    // An edge without a length turns nothing.
    let bent_edge = bent.next.xyz - bent.here.xyz;
    let lengths = vec2(dot(goal, goal), dot(bent_edge, bent_edge));
    if (min(lengths.x, lengths.y) > NO_LENGTH) {
        bent.frame = turned(edge.frame, goal * inverseSqrt(lengths.x), bent_edge * inverseSqrt(lengths.y));
    }
    return bent;
}

fn from_root(root: vec3<f32>, position: vec4<f32>) -> vec4<f32> {
    return vec4(position.xyz - root, position.w);
}
