// Local shape constraints: each edge wants the angle to the edge before it that it has in the rest pose. From the root to
// the tip, several times. One thread a guide.

import package::constants::{GUIDES, ITERATIONS, STRANDS, VERTICES};
import package::grid::{GROUP, thread_index};
import package::step::Step;
import package::vector::{NO_LENGTH, rotate, turn};

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
        @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= GUIDES) { return; }
    for (var iteration = 0u; iteration < ITERATIONS; iteration++) {
        walk(strand);
    }
}

fn walk(strand: u32) {
    var before = positions[strand].xyz;
    var here = positions[STRANDS + strand];
    var next = positions[2u * STRANDS + strand];
    var rest_here = rest[GUIDES + strand].xyz;
    var rest_next = rest[2u * GUIDES + strand].xyz;
    var rest_edge = rotate(step.head_rotation, rest_here - rest[strand].xyz);
    // The directions of the last edge that has one, in the rest pose and now.
    var rest_direction = vec3(1.0, 0.0, 0.0);
    var direction = rest_direction;
    for (var i = 1u; i < VERTICES - 1u; i++) {
        // Loaded before this vertex is stored: loads behind a store to the same buffer would wait for it.
        let ahead = min(i + 2u, VERTICES - 1u);
        let position_ahead = positions[ahead * STRANDS + strand];
        let rest_ahead = rest[ahead * GUIDES + strand].xyz;

        let edge = here.xyz - before;
        let rest_squared = dot(rest_edge, rest_edge);
        let squared = dot(edge, edge);
        if (min(rest_squared, squared) > NO_LENGTH) {
            rest_direction = rest_edge * inverseSqrt(rest_squared);
            direction = edge * inverseSqrt(squared);
        }
        rest_edge = rotate(step.head_rotation, rest_next - rest_here);
        let goal = here.xyz + turn(rest_direction, direction, rest_edge);
        let correction = step.local_stiffness * (goal - next.xyz);
        here = vec4(here.xyz - select(vec3(0.0), correction, here.w > 0.0), here.w);
        next = vec4(next.xyz + select(vec3(0.0), correction, next.w > 0.0), next.w);
        positions[i * STRANDS + strand] = here;

        before = here.xyz;
        here = next;
        next = position_ahead;
        rest_here = rest_next;
        rest_next = rest_ahead;
    }
    positions[(VERTICES - 1u) * STRANDS + strand] = here;
}
