// Unit tangents towards the tip: the mean of the directions of the two edges that meet. One thread a vertex of any strand.

import package::grid::{GROUP, thread_index};
import package::step::step;
import package::vector::{NO_LENGTH, direction_or};

@group(0) @binding(1) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> strand_tangents: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn tangents(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
            @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= step.strands) { return; }
    let vertex = group.z;
    let i = vertex * step.strands + strand;
    let here = positions[i].xyz;
    var sum = vec3(0.0);
    if (vertex > 0u) { sum += direction_or(here - positions[i - step.strands].xyz, vec3(0.0)); }
    if (vertex + 1u < step.vertices) { sum += direction_or(positions[i + step.strands].xyz - here, vec3(0.0)); }
    if (dot(sum, sum) <= NO_LENGTH) { sum = nearest_edge(strand, vertex); }
    strand_tangents[i] = vec4(normalize(sum), 0.0);
}

/// The direction of the nearest edge that has one, first towards the tip, then towards the root; up if none has.
fn nearest_edge(strand: u32, vertex: u32) -> vec3<f32> {
    for (var distance = 0u; distance < step.vertices; distance++) {
        let after = vertex + distance;
        if (after + 1u < step.vertices) {
            let found = edge(strand, after);
            if (dot(found, found) > NO_LENGTH) { return found; }
        }
        if (vertex > distance) {
            let found = edge(strand, vertex - distance - 1u);
            if (dot(found, found) > NO_LENGTH) { return found; }
        }
    }
    return vec3(0.0, 1.0, 0.0);
}

fn edge(strand: u32, vertex: u32) -> vec3<f32> {
    return positions[(vertex + 1u) * step.strands + strand].xyz - positions[vertex * step.strands + strand].xyz;
}
