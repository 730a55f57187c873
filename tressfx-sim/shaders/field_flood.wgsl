// A pass of the flood (jump flooding: Rong, Tan 2006): a node takes over the triangle of the node, of those at some distance around it, whose
// nearest point is nearest to itself, and finds the nearest point of that triangle. One thread a node.

import package::field_mesh::{build, in_cells, mesh_triangle, nearest_on, node_count, squared_distance};
import package::grid::{GROUP, thread_index};
import package::nodes::{node_at, node_index};

@group(0) @binding(4) var<storage, read> known_points: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read_write> nearest_points: array<vec4<u32>>;

@compute @workgroup_size(GROUP)
fn field_flood(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let index = thread_index(group, groups, lane);
    if (index >= node_count()) { return; }
    let node = node_at(index, build.nodes);
    let point = vec3<f32>(node);
    let own = known_points[index];
    var best = own;
    var least = 1e30;
    if (own.w != 0u) { least = squared_distance(point, bitcast<vec3<f32>>(own.xyz)); }
    for (var around = 0u; around < 27u; around++) {
        // Those before the first wrap around to large numbers.
        let side = vec3(around % 3u, around / 3u % 3u, around / 9u);
        let other = node + side * build.reach - build.reach;
        if (any(other >= build.nodes)) { continue; }
        let known = known_points[node_index(other, build.nodes)];
        if (known.w == 0u) { continue; }
        let squared = squared_distance(point, bitcast<vec3<f32>>(known.xyz));
        if (squared < least || (squared == least && known.w < best.w)) {
            least = squared;
            best = known;
        }
    }
    if (best.w != own.w) {
        let nearest = nearest_on(in_cells(mesh_triangle(best.w - 1u)), point);
        best = vec4(bitcast<vec3<u32>>(nearest), best.w);
    }
    nearest_points[index] = best;
}
