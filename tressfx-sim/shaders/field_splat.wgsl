// The nearest triangle of each node that is near the surface, exactly. Sixteen lanes a triangle go through the nodes around it. What a
// node keeps is one integer, of which the largest stays, so that no order of threads matters: the distance in coarse steps, then the index.

import package::field_mesh::{
    Triangle, build, in_cells, is_sound, is_wide, mesh_triangle, nearest_on, squared_distance,
};
import package::grid::{GROUP, thread_index};
import package::nodes::node_index;

/// The complement of the steps and the index; 0 where no triangle is near.
@group(0) @binding(4) var<storage, read_write> band: array<atomic<u32>>;

const LANES: u32 = 16u;
/// Cells from the surface.
const BAND: f32 = 1.5;

/// The nodes around a triangle, from the least to the last, none where one of the last is less.
struct Around { least: vec3<i32>, last: vec3<i32> }

@compute @workgroup_size(GROUP)
fn field_splat(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let thread = thread_index(group, groups, lane);
    let index = thread / LANES;
    if (index >= build.triangles) { return; }
    let in_mesh = mesh_triangle(index);
    if (!is_sound(in_mesh)) { return; }
    let triangle = in_cells(in_mesh);
    let around = nodes_around(triangle);
    let normal = cross(triangle.b - triangle.a, triangle.c - triangle.a);
    let squared = dot(normal, normal);
    // Lanes go through rows along the axis that the triangle faces most, where few nodes of a row are near its plane.
    let w = main_axis(normal);
    let u = (w + 1u) % 3u;
    let v = (w + 2u) % 3u;
    let wide = is_wide(triangle, squared);
    let reach = select(1e9, BAND * sqrt(squared) / abs(normal[w]), wide);
    let width = around.last[u] - around.least[u] + 1;
    let rows = width * (around.last[v] - around.least[v] + 1);
    for (var row = i32(thread % LANES); row < rows; row += i32(LANES)) {
        var node: vec3<i32>;
        node[u] = around.least[u] + row % width;
        node[v] = around.least[v] + row / width;
        let off = (f32(node[u]) - triangle.a[u]) * normal[u] + (f32(node[v]) - triangle.a[v]) * normal[v];
        let middle = select(triangle.a[w], triangle.a[w] - off / normal[w], wide);
        let first = max(around.least[w], i32(ceil(max(middle - reach, -1.0))));
        let last = min(around.last[w], i32(floor(min(middle + reach, 1e6))));
        for (node[w] = first; node[w] <= last; node[w]++) { keep_nearest(triangle, index, vec3<u32>(node)); }
    }
}

fn nodes_around(triangle: Triangle) -> Around {
    let least = min(min(triangle.a, triangle.b), triangle.c) - BAND;
    let most = max(max(triangle.a, triangle.b), triangle.c) + BAND;
    let end = vec3<f32>(build.nodes) - 1.0;
    return Around(vec3<i32>(ceil(max(least, vec3(0.0)))), vec3<i32>(floor(min(most, end))));
}

fn main_axis(normal: vec3<f32>) -> u32 {
    let size = abs(normal);
    if (size.x > size.y && size.x > size.z) { return 0u; }
    return select(2u, 1u, size.y > size.z);
}

fn keep_nearest(triangle: Triangle, index: u32, node: vec3<u32>) {
    let point = vec3<f32>(node);
    let apart = sqrt(squared_distance(point, nearest_on(triangle, point)));
    if (apart >= BAND) { return; }
    // One step less than there are, so that the complement is never 0.
    let steps = f32((1u << (32u - build.index_bits)) - 2u);
    let packed = (u32(apart / BAND * steps) << build.index_bits) | index;
    atomicMax(&band[node_index(node, build.nodes)], ~packed);
}
