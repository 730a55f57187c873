// What the flood begins with: of each node near the surface, the nearest point of its nearest triangle. One thread a node.

import package::field_mesh::{build, in_cells, mesh_triangle, nearest_on, node_count};
import package::grid::{GROUP, thread_index};
import package::nodes::node_at;

@group(0) @binding(4) var<storage, read> band: array<u32>;
/// The bits of the point, in cells, and the index of its triangle and 1; 0 where nothing is known yet.
@group(0) @binding(5) var<storage, read_write> nearest_points: array<vec4<u32>>;

@compute @workgroup_size(GROUP)
fn field_seed(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let index = thread_index(group, groups, lane);
    if (index >= node_count()) { return; }
    let kept = band[index];
    if (kept == 0u) {
        nearest_points[index] = vec4(0u);
        return;
    }
    let of_triangle = ~kept & ((1u << build.index_bits) - 1u);
    let point = nearest_on(in_cells(mesh_triangle(of_triangle)), vec3<f32>(node_at(index, build.nodes)));
    nearest_points[index] = vec4(bitcast<vec3<u32>>(point), of_triangle + 1u);
}
