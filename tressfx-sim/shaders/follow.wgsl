// Places the follow strands beside their guides. One thread a vertex of a follow strand.

import package::grid::{GROUP, thread_index};
import package::root::root_of;
import package::step::step;
import package::vector::rotate;

@group(0) @binding(1) var<storage, read> follow_offsets: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn follow(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) lane: u32) {
    // Follow strands come behind the guides, those of all guides in the same order.
    let follow = thread_index(group, groups, lane);
    if (follow >= step.strands - step.guides) { return; }
    let guide = follow % step.guides;
    let vertex = group.z;
    let offset = rotate(root_of(guide).rotation, follow_offsets[follow].xyz);
    let position = positions[vertex * step.strands + guide];
    positions[vertex * step.strands + step.guides + follow] = vec4(beside(position.xyz, offset, vertex), position.w);
}

/// The place of a follow strand's vertex beside that of its guide; `offset` is the one between their roots.
fn beside(guide: vec3<f32>, offset: vec3<f32>, vertex: u32) -> vec3<f32> {
    let spread = 1.0 + step.tip_separation * f32(vertex) / f32(step.vertices - 1u);
    return guide + spread * offset;
}
