// The signed distance of each node: negative where the winding number of the mesh is more than a half. One thread a node.
//
// The winding number is how often the way along z leaves the mesh more than it enters it; where the mesh has open edges, it is that and the
// solid angles between each of them and -z (the chain of open edges is the boundary of the mesh, and with cones from it to infinity the mesh
// is closed). That is the generalised winding number (Jacobson et al. 2013), exactly, without a sum over all triangles.

import package::field::NO_SURFACE;
import package::field_mesh::{build, grid, node_count};
import package::grid::{GROUP, thread_index};
@if(open_edges)
import package::field_mesh::{is_near, to_cells, vertex_at};
@if(open_edges)
import package::field_side::{is_left, part_of, twice_area};
import package::nodes::{node_at, node_index};

@group(0) @binding(4) var<storage, read> known_points: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> crossings: array<i32>;
@group(0) @binding(6) var<storage, read_write> all_fields: array<u32>;
/// From vertex to vertex, and how often.
@if(open_edges)
@group(0) @binding(7) var<storage, read> open_edges: array<vec4<i32>>;

@compute @workgroup_size(GROUP)
fn field_sign(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let index = thread_index(group, groups, lane);
    if (index >= node_count()) { return; }
    let node = node_at(index, build.nodes);
    var left = 0;
    for (var z = node.z; z < build.nodes.z; z++) { left += crossings[node_index(vec3(node.xy, z), build.nodes)]; }
    var winding = f32(left);
    @if(open_edges) {
        winding += turns_of_open_edges(vec3<f32>(node), vec2<i32>(node.xy) * build.parts);
    }
    let known = known_points[index];
    var away = NO_SURFACE;
    if (known.w != 0u) {
        away = grid.cell * distance(vec3<f32>(node), bitcast<vec3<f32>>(known.xyz));
    }
    all_fields[build.first_word + index] = bitcast<u32>(select(away, -away, winding > 0.5));
}

/// The solid angles of the open edges and -z, in whole spheres.
@if(open_edges)
fn turns_of_open_edges(point: vec3<f32>, line: vec2<i32>) -> f32 {
    var turns = 0.0;
    for (var i = 0u; i < build.open_edges; i++) {
        let edge = open_edges[i];
        let one = vertex_at(u32(edge.x));
        let other = vertex_at(u32(edge.y));
        if (!is_near(one) || !is_near(other)) { continue; }
        turns += f32(edge.z) * turn_of(to_cells(one), to_cells(other), point, line);
    }
    return turns;
}

/// The solid angle of the triangle of an edge and -z (Van Oosterom, Strackee 1983), in whole spheres. Which side the line passes on is found
/// in integers, as for the crossings: both jump by one together.
@if(open_edges)
fn turn_of(one: vec3<f32>, other: vec3<f32>, point: vec3<f32>, line: vec2<i32>) -> f32 {
    let a_parts = part_of(one) - line;
    let b_parts = part_of(other) - line;
    let scale = 1.0 / f32(build.parts);
    let a = vec3(vec2<f32>(a_parts) * scale, one.z - point.z);
    let b = vec3(vec2<f32>(b_parts) * scale, other.z - point.z);
    // Never 0, so that a line through the edge has a side.
    let size = max(abs(f32(twice_area(a_parts, b_parts))) * scale * scale, 1e-12);
    let volume = select(size, -size, is_left(a_parts, b_parts));
    let a_length = sqrt(dot(a, a));
    let b_length = sqrt(dot(b, b));
    let under = a_length * b_length + dot(a, b) - a_length * b.z - b_length * a.z;
    return atan2(volume, under) / 6.28318530718;
}
