// Where the lines through the nodes along z leave the mesh and enter it: the sum over all nodes from one on is how often the way from there
// along z leaves more than it enters. Sixteen lanes a triangle go through the lines that may cross it. Places across the lines are integers, parts
// of a cell, so that of two triangles with a common edge exactly one is crossed, whatever the rounding.

import package::field_mesh::{Triangle, build, in_cells, is_sound, mesh_triangle};
import package::grid::{GROUP, thread_index};
import package::field_side::{is_left, part_of, twice_area};
import package::nodes::node_index;

@group(0) @binding(4) var<storage, read_write> crossings: array<atomic<i32>>;

const LANES: u32 = 16u;

@compute @workgroup_size(GROUP)
fn field_crossings(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                   @builtin(local_invocation_index) lane: u32) {
    let thread = thread_index(group, groups, lane);
    let index = thread / LANES;
    if (index >= build.triangles) { return; }
    let in_mesh = mesh_triangle(index);
    if (!is_sound(in_mesh)) { return; }
    let triangle = in_cells(in_mesh);
    let a = part_of(triangle.a);
    let b = part_of(triangle.b);
    let c = part_of(triangle.c);
    let area = twice_area(b - a, c - a);
    if (area == 0) { return; }
    // All coordinates are positive: the mesh lies within the nodes.
    let least = (min(min(a, b), c) + build.parts - 1) / build.parts;
    let last = max(max(a, b), c) / build.parts;
    let width = last.x - least.x + 1;
    let lines = width * (last.y - least.y + 1);
    for (var line = i32(thread % LANES); line < lines; line += i32(LANES)) {
        let column = vec2(least.x + line % width, least.y + line / width);
        let at = column * build.parts;
        let left = vec3(is_left(a - at, b - at), is_left(b - at, c - at), is_left(c - at, a - at));
        if (!select(!any(left), all(left), area > 0)) { continue; }
        let shares = vec3<f32>(
            f32(twice_area(b - at, c - at)), f32(twice_area(c - at, a - at)), f32(twice_area(a - at, b - at)));
        let heights = vec3(triangle.a.z, triangle.b.z, triangle.c.z);
        let crossed = clamp(dot(shares, heights) / f32(area), min(heights.x, min(heights.y, heights.z)),
                            max(heights.x, max(heights.y, heights.z)));
        let node = min(i32(ceil(crossed)), i32(build.nodes.z)) - 1;
        if (node < 0) { continue; }
        let place = node_index(vec3<u32>(vec3(column, node)), build.nodes);
        atomicAdd(&crossings[place], select(-1, 1, area > 0));
    }
}
