// Local shape constraints: each edge wants the angle to the edge before it that it has in the rest pose, and the first edge
// that to the head. From the root to the tip, several times. One thread a guide.

import package::constants::{GUIDES, ITERATIONS, STRANDS, VERTICES};
import package::grid::{GROUP, thread_index};
import package::step::Step;
import package::vector::{NO_LENGTH, rotate, turned};

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn local_shape(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= GUIDES) { return; }
    for (var iteration = 0u; iteration < ITERATIONS; iteration++) {
        walk(strand);
    }
}

fn walk(strand: u32) {
    // What the strand has turned so far. It starts as the head does, and each edge adds the smallest turn that explains it:
    // so a curl that is turned as a whole is still the same curl.
    var frame = step.head_rotation;
    // Positions are about the root, see `length`.
    let root = positions[strand].xyz;
    var here = vec4(vec3(0.0), positions[strand].w);
    var next = about(root, positions[STRANDS + strand]);
    var rest_here = rest[strand].xyz;
    var rest_next = rest[GUIDES + strand].xyz;
    for (var i = 0u; i < VERTICES - 1u; i++) {
        // Loaded before this vertex is stored: loads behind a store to the same buffer would wait for it.
        let ahead = min(i + 2u, VERTICES - 1u);
        let position_ahead = about(root, positions[ahead * STRANDS + strand]);
        let rest_ahead = rest[ahead * GUIDES + strand].xyz;

        let goal = rotate(frame, rest_next - rest_here);
        let mass = here.w + next.w;
        let share = select(step.local_stiffness / mass, 0.0, mass == 0.0);
        let correction = share * (goal - (next.xyz - here.xyz));
        here -= vec4(here.w * correction, 0.0);
        next += vec4(next.w * correction, 0.0);
        positions[i * STRANDS + strand] = about(-root, here);

        // An edge without a length turns nothing.
        let edge = next.xyz - here.xyz;
        let lengths = vec2(dot(goal, goal), dot(edge, edge));
        if (min(lengths.x, lengths.y) > NO_LENGTH) {
            frame = turned(frame, goal * inverseSqrt(lengths.x), edge * inverseSqrt(lengths.y));
        }
        here = next;
        next = position_ahead;
        rest_here = rest_next;
        rest_next = rest_ahead;
    }
    positions[(VERTICES - 1u) * STRANDS + strand] = about(-root, here);
}

fn about(origin: vec3<f32>, position: vec4<f32>) -> vec4<f32> {
    return vec4(position.xyz - origin, position.w);
}
