// Places the follow strands beside their guides. One thread a vertex of a guide.

import package::constants::{FOLLOWS, GUIDES, STRANDS, VERTICES};
import package::grid::{GROUP, thread_index};
import package::step::Step;
import package::vector::rotate;

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> follow_offsets: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn follow(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if (i >= GUIDES * VERTICES) { return; }
    let vertex = i / GUIDES;
    let guide = i % GUIDES;
    let position = positions[vertex * STRANDS + guide];
    let spread = 1.0 + step.tip_separation * f32(vertex) / f32(VERTICES - 1u);
    for (var follow = 0u; follow < FOLLOWS; follow++) {
        let offset = rotate(step.head_rotation, follow_offsets[follow * GUIDES + guide].xyz);
        positions[vertex * STRANDS + (1u + follow) * GUIDES + guide] = vec4(position.xyz + spread * offset, position.w);
    }
}
