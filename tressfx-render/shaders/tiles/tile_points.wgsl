// The vertices of a section before the eye, beside those of all other sections: so that one kernel can draw segments of all of
// them; and the nearest vertex of each tile. One thread a vertex.

import package::grid::{GROUP, thread_index};
import package::ribbon::{End, is_sound, on_screen};
import package::screen::view;
import package::strands::{colors, end_at, positions, section};
import package::tiles::{TILE, tile_columns};

@group(0) @binding(6) var<storage, read_write> points: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> paints: array<vec2<u32>>;

// Nearness, a tile: bits of a number that is not negative.
@group(0) @binding(8) var<storage, read_write> nearests: array<atomic<u32>>;

// The nearest vertex is looked for among so many strands: it decides about speed alone.
const SAMPLES: u32 = 8192u;
// A point that nothing is drawn from.
const NOWHERE: vec4<f32> = vec4(3e38, 3e38, 3e38, 0.0);

fn note_nearest(end: End) {
    let distance = -end.point.z;
    if distance < view.lens.near {
        return;
    }
    var scale = 1.0;
    var nearness = 1.0 - view.lens.nearness_slope * distance;
    if view.lens.is_perspective == 1u {
        scale = 1.0 / distance;
        nearness = scale;
    }
    let pixel = on_screen(view.lens, end.point.xy, scale);
    if all(pixel >= vec2(0.0)) && all(pixel < vec2<f32>(view.size)) && nearness > 0.0 {
        let tile = vec2<u32>(pixel) / TILE;
        let place = tile.y * tile_columns() + tile.x;
        let bits = bitcast<u32>(nearness);
        // Most vertices are not the nearest, and need no turn at the counter.
        if bits > atomicLoad(&nearests[place]) {
            atomicMax(&nearests[place], bits);
        }
    }
}

@compute @workgroup_size(GROUP)
fn tile_points(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if i >= section.strands * section.vertices {
        return;
    }
    let end = end_at(i % section.strands, i / section.strands);
    let sound = is_sound(positions[i].xyz);
    points[i] = select(NOWHERE, vec4(end.point, end.radius), sound);
    paints[i] = colors[i];
    let step = max(section.strands / SAMPLES, 1u);
    if sound && (i % section.strands) % step == 0u {
        note_nearest(end);
    }
}
