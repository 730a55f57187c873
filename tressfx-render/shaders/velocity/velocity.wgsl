// How far the hair of each pixel has moved on the screen since the frame before. Six vertices for each tile with hair; a section
// writes the pixels whose segment is its own.

import package::corner::corner_of_tile;
import package::line::{line_of, place_of};
import package::motion::MotionUniform;
import package::ribbon::{along, is_sound};
import package::screen::view;
import package::strands::{placed, positions, ribbon_of, section, strand_at, vertex_of};

@group(0) @binding(6) var<storage, read> past_positions: array<vec4<f32>>;
// The numbers of segments, from 1; 0 is no hair.
@group(0) @binding(7) var<storage, read> segments: array<u32>;
@group(0) @binding(8) var<uniform> motion: MotionUniform;
@group(0) @binding(9) var<storage, read> tiles: array<vec2<u32>>;

@vertex
fn tile_corner(@builtin(vertex_index) vertex: u32) -> @builtin(position) vec4<f32> {
    return corner_of_tile(tiles[vertex / 6u].x, vertex % 6u, view.size, view.offset, view.target_size);
}

// Pixels between where the point of a segment is and where it was, 0 where that was not before the eye. `share` says which point.
fn moved(now: array<vec3<f32>, 2>, past: array<vec3<f32>, 2>, share: f32) -> vec2<f32> {
    let here = motion.now * vec4(mix(now[0], now[1], share), 1.0);
    let there = motion.past * vec4(mix(past[0], past[1], share), 1.0);
    if !is_sound(past[0]) || !is_sound(past[1]) || there.w <= 0.0 {
        return vec2(0.0);
    }
    return here.xy / here.w - there.xy / there.w - motion.jitter;
}

@fragment
fn velocity(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(position.xy) - view.offset;
    // Numbers of sections before this one wrap to more than it has.
    let segment = segments[pixel.y * view.size.x + pixel.x] - 1u - motion.first;
    if segment >= section.lod.strands * (section.lod.vertices - 1u) {
        discard;
    }
    let strand = strand_at(segment % section.lod.strands);
    let vertex = segment / section.lod.strands;
    let ribbon = ribbon_of(strand, vertex);
    let share = along(ribbon, max(place_of(ribbon, line_of(ribbon), pixel), 0.0));
    let start = vertex_of(strand, vertex);
    let end = vertex_of(strand, vertex + 1u);
    let now = array(placed(strand, positions[start]), placed(strand, positions[end]));
    let past = array(placed(strand, past_positions[start]), placed(strand, past_positions[end]));
    return vec4(moved(now, past, share), 0.0, 0.0);
}
