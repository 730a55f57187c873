// The vertices of a section on the screen, beside those of all other sections: so that one kernel can draw segments of all of
// them; and how many vertices are in each range of depth of each tile. One thread a vertex.

import package::grid::{GROUP, thread_index};
import package::ribbon::{End, is_sound, on_screen};
import package::screen::{scene_nearness, view};
import package::strands::{colors, end_at, positions, section};
import package::tiles::{RANGES, TILE, distance_of, in_ranges, tile_columns};

@group(0) @binding(6) var<storage, read_write> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> paints: array<vec2<u32>>;

// Vertices, a range of a tile.
@group(0) @binding(8) var<storage, read_write> shares: array<atomic<u32>>;

// The vertices of so many strands are counted: the counts decide about speed alone.
const SAMPLES: u32 = 8192u;
// A point that nothing is drawn from.
const NOWHERE: vec4<f32> = vec4(3e38, 3e38, 3e38, 0.0);

// A vertex as `segments` reads it.
fn point_of(end: End) -> vec4<f32> {
    let distance = -end.point.z;
    if distance <= view.lens.near {
        return vec4(end.point, -max(end.radius, 1e-30));
    }
    var scale = 1.0;
    var nearness = 1.0 - view.lens.nearness_slope * distance;
    if view.lens.is_perspective == 1u {
        scale = 1.0 / distance;
        nearness = scale;
    }
    return vec4(on_screen(view.lens, end.point.xy, scale), nearness, end.radius * scale);
}

// Counts a vertex in its tile and range, unless the scene hides it.
fn count(point: vec4<f32>) {
    if point.w < 0.0 || any(point.xy < vec2(0.0)) || any(point.xy >= vec2<f32>(view.size)) {
        return;
    }
    let pixel = vec2<u32>(point.xy);
    if point.z < scene_nearness(pixel) {
        return;
    }
    let tile = pixel.y / TILE * tile_columns() + pixel.x / TILE;
    atomicAdd(&shares[tile * RANGES + min(u32(in_ranges(distance_of(point.z))), RANGES - 1u)], 1u);
}

@compute @workgroup_size(GROUP)
fn tile_points(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if i >= section.strands * section.vertices {
        return;
    }
    let sound = is_sound(positions[i].xyz);
    let point = select(NOWHERE, point_of(end_at(i % section.strands, i / section.strands)), sound);
    points[i] = point;
    paints[i] = colors[i];
    let step = max(section.strands / SAMPLES, 1u);
    if sound && (i % section.strands) % step == 0u {
        count(point);
    }
}
