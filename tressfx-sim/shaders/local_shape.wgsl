// Local shape constraints: each edge wants the angle to the edge before it that it has in the rest pose, and the first edge
// that to the head. From the root to the tip, several times. One thread a guide.

import package::constants::{GUIDES, ITERATIONS, STRANDS, VERTICES};
import package::grid::{GROUP, thread_index};
import package::step::Step;
import package::vector::{NO_LENGTH, rotate, turned};
import package::walk::CHUNK;

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
    var here = positions[strand];
    var rest_here = rest[strand].xyz;
    for (var start = 1u; start < VERTICES; start += CHUNK) {
        var chunk: array<vec4<f32>, CHUNK>;
        var rest_chunk: array<vec3<f32>, CHUNK>;
        for (var i = 0u; i < CHUNK; i++) {
            let vertex = min(start + i, VERTICES - 1u);
            chunk[i] = positions[vertex * STRANDS + strand];
            rest_chunk[i] = rest[vertex * GUIDES + strand].xyz;
        }
        for (var i = 0u; i < CHUNK; i++) {
            if (start + i < VERTICES) {
                var next = chunk[i];
                let goal = rotate(frame, rest_chunk[i] - rest_here);
                let mass = here.w + next.w;
                let share = select(0.0, step.local_stiffness / mass, mass > 0.0);
                let correction = share * (goal - (next.xyz - here.xyz));
                here -= vec4(here.w * correction, 0.0);
                next += vec4(next.w * correction, 0.0);
                positions[(start + i - 1u) * STRANDS + strand] = here;
                frame = carried(frame, goal, next.xyz - here.xyz);
                here = next;
                rest_here = rest_chunk[i];
            }
        }
    }
    positions[(VERTICES - 1u) * STRANDS + strand] = here;
}

/// The frame behind an edge that was to be `goal` and is `edge`. An edge without a length turns nothing.
fn carried(frame: vec4<f32>, goal: vec3<f32>, edge: vec3<f32>) -> vec4<f32> {
    let lengths = vec2(dot(goal, goal), dot(edge, edge));
    if (min(lengths.x, lengths.y) <= NO_LENGTH) { return frame; }
    return turned(frame, goal * inverseSqrt(lengths.x), edge * inverseSqrt(lengths.y));
}
