// Places the follow strands beside their guides. One thread a vertex of a follow strand: along x the guides, along y their
// follow strands, along z the vertices.

import package::grid::GROUP;
import package::root::root_of;
import package::step::step;
import package::vector::rotate;

@group(0) @binding(1) var<storage, read> follow_offsets: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn follow(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) lane: u32) {
    let vertex = group.z;
    // The grid may hold fewer than all of them.
    for (var guide = group.x * GROUP + lane; guide < step.guides; guide += groups.x * GROUP) {
        let rotation = root_of(guide).rotation;
        let position = positions[vertex * step.strands + guide];
        for (var follow = group.y; follow < step.follows; follow += groups.y) {
            let offset = rotate(rotation, follow_offsets[follow * step.guides + guide].xyz);
            let place = vertex * step.strands + (1u + follow) * step.guides + guide;
            positions[place] = vec4(beside(position.xyz, offset, vertex), position.w);
        }
    }
}

/// The place of a follow strand's vertex beside that of its guide; `offset` is the one between their roots.
fn beside(guide: vec3<f32>, offset: vec3<f32>, vertex: u32) -> vec3<f32> {
    let spread = 1.0 + step.tip_separation * f32(vertex) / f32(step.vertices - 1u);
    return guide + spread * offset;
}
