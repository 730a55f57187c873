// The segments of all sections, before the eye: what `hair.render.tile_points` has left.

import package::line::Paint;
import package::ribbon::{End, Ribbon, clip, is_sound, project};
import package::screen::view;
import package::tiles::tiles;

// A point in the space of the eye and a radius, a vertex.
@group(0) @binding(2) var<storage, read> points: array<vec4<f32>>;
// Colour and opacity as four half floats, a vertex.
@group(0) @binding(3) var<storage, read> paints: array<vec2<u32>>;

// Vertices of a segment.
struct Segment {
    start: u32,
    end: u32,
}

// A segment by its number.
fn segment_at(index: u32) -> Segment {
    var section = tiles.layouts[0];
    for (var i = 1u; i < tiles.sections && index >= tiles.layouts[i].x; i++) {
        section = tiles.layouts[i];
    }
    let start = section.y + index - section.x;
    return Segment(start, start + section.z);
}

// A segment by its first vertex.
fn segment_from(start: u32) -> Segment {
    var section = tiles.layouts[0];
    for (var i = 1u; i < tiles.sections && start >= tiles.layouts[i].y; i++) {
        section = tiles.layouts[i];
    }
    return Segment(start, start + section.z);
}

fn ribbon_of(segment: Segment) -> Ribbon {
    let a = points[segment.start];
    let b = points[segment.end];
    if !is_sound(a.xyz) || !is_sound(b.xyz) {
        return Ribbon();
    }
    let ribbon = project(End(a.xyz, a.w), End(b.xyz, b.w), view.lens);
    return clip(ribbon, view.lens, vec2<f32>(view.size), max(ribbon.half_width.x, ribbon.half_width.y) + 2.0);
}

fn paint_at(vertex: u32) -> vec4<f32> {
    return vec4(unpack2x16float(paints[vertex].x), unpack2x16float(paints[vertex].y));
}

fn paint_of(segment: Segment) -> Paint {
    return Paint(paint_at(segment.start), paint_at(segment.end));
}
