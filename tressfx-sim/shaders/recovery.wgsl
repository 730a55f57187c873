// The guard against strands that have become non-finite: they go back to their rest pose, at rest, and are counted.
// One thread a guide.

import package::grid::{GROUP, thread_index};
import package::root::{root_of, shape_of};
import package::step::step;
import package::vector::is_finite;

@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> positions: array<vec4<f32>>;
/// Strands that were reset because they had become non-finite.
@group(0) @binding(4) var<storage, read_write> non_finite: atomic<u32>;

@compute @workgroup_size(GROUP)
fn recovery(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
            @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= step.guides) { return; }
    var finite = true;
    for (var i = 0u; i < step.vertices; i++) {
        finite = finite && is_finite(positions[i * step.strands + strand].xyz);
    }
    if (finite) { return; }
    let root = root_of(strand);
    for (var i = 0u; i < step.vertices; i++) {
        let vertex = rest[i * step.guides + strand];
        let shape = shape_of(root, vertex.xyz);
        positions[i * step.strands + strand] = vec4(shape, vertex.w);
        previous[i * step.guides + strand] = vec4(shape, 0.0);
    }
    atomicAdd(&non_finite, 1u);
}
