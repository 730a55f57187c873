// The vertices of a section on the screen, beside those of all other sections: so that one kernel can draw segments of all of
// them; and the nearest vertex of each tile. One thread a vertex.

import package::grid::{GROUP, thread_index};
import package::joint::ROUND;
import package::ribbon::{End, on_screen, scale_of};
import package::screen::view;
import package::strands::{Strand, bend_at, end_at, is_sound_at, neighbours_of, paint_between, section, strand_at, tilt_between};
import package::tile::TILE;
import package::tiles::{SharedTileInfo, nearness_at, tile_columns};

@group(0) @binding(6) var<storage, read_write> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> paints: array<vec4<u32>>;

@group(0) @binding(8) var<storage, read_write> infos: array<SharedTileInfo>;

// The nearest vertex is looked for among so many strands: it decides about speed alone.
const SAMPLES: u32 = 8192u;
// A point that nothing is drawn from.
const NOWHERE: vec4<f32> = vec4(3e38, 3e38, 3e38, 0.0);

// A vertex as `segments` reads it.
fn point_of(end: End) -> vec4<f32> {
    let distance = -end.point.z;
    if distance <= view.lens.near {
        return vec4(end.point, -max(end.radius, 1e-30));
    }
    let nearness = nearness_at(distance);
    let scale = scale_of(view.lens, vec2(nearness)).x;
    return vec4(on_screen(view.lens, end.point.xy, scale), nearness, end.radius * scale);
}

fn paint_of_vertex(strand: Strand, vertex: u32) -> vec4<u32> {
    let beside = neighbours_of(strand, vertex);
    let bend = bend_at(strand, vertex, beside);
    let paint = paint_between(bend, strand, vertex, beside);
    let tilt = select(tilt_between(bend), ROUND, any(beside == vec2(vertex)));
    return vec4(pack2x16float(paint.rg), pack2x16float(paint.ba), bitcast<u32>(tilt), 0u);
}

fn note_nearest(point: vec4<f32>) {
    if point.w < 0.0 || any(point.xy < vec2(0.0)) || any(point.xy >= vec2<f32>(view.size)) || point.z <= 0.0 {
        return;
    }
    let tile = vec2<u32>(point.xy) / TILE;
    let place = tile.y * tile_columns() + tile.x;
    // Numbers that are not negative are in the order of their bits.
    let bits = bitcast<u32>(point.z);
    // Most vertices are not the nearest, and need no turn at the counter.
    if bits > atomicLoad(&infos[place].nearest) {
        atomicMax(&infos[place].nearest, bits);
    }
}

@compute @workgroup_size(GROUP)
fn tile_points(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if i >= section.lod.strands * section.lod.vertices {
        return;
    }
    let number = i % section.lod.strands;
    let strand = strand_at(number);
    let vertex = i / section.lod.strands;
    let sound = is_sound_at(strand, vertex);
    let point = select(NOWHERE, point_of(end_at(strand, vertex)), sound);
    points[i] = point;
    paints[i] = paint_of_vertex(strand, vertex);
    let step = max(section.lod.strands / SAMPLES, 1u);
    if sound && number % step == 0u {
        note_nearest(point);
    }
}
