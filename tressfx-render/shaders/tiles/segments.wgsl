// The segments of all sections on the screen: what `hair.render.tile_points` has left.

import package::line::Paint;
import package::ribbon::{End, Ribbon, clip, is_sound, margin_of, project, scale_of, width_scale};
import package::screen::view;
import package::tiles::{distance_of, tiles};

// A vertex: its pixel, nearness, and radius / w. Where it is not beyond the near plane: its point in the space of the eye, and
// its radius below 0.
@group(0) @binding(2) var<storage, read> points: array<vec4<f32>>;
// Colour and opacity of the surface at a vertex, as four half floats, and the bits of its tilt.
@group(0) @binding(3) var<storage, read> paints: array<vec4<u32>>;

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

// Coordinates in pixels up to which a ribbon need not be cut to the screen.
const LARGEST_PIXEL: f32 = 32768.0;

// A vertex before the eye again.
fn end_of(point: vec4<f32>) -> End {
    if point.w < 0.0 {
        return End(point.xyz, -point.w);
    }
    let scale = scale_of(view.lens, point.zz).x;
    let right = (point.x - view.lens.center.x) / (view.lens.focal.x * scale);
    let up = (view.lens.center.y - point.y - view.lens.skew * scale * right) / (view.lens.focal.y * scale);
    return End(vec3(right, up, -distance_of(point.z)), point.w / scale);
}

fn ribbon_of(segment: Segment) -> Ribbon {
    let a = points[segment.start];
    let b = points[segment.end];
    if !is_sound(a.xyz) || !is_sound(b.xyz) {
        return Ribbon();
    }
    let tilt = bitcast<vec2<f32>>(vec2(paints[segment.start].z, paints[segment.end].z));
    if min(a.w, b.w) >= 0.0 && all(max(abs(a.xy), abs(b.xy)) < vec2(LARGEST_PIXEL)) {
        let nearness = vec2(a.z, b.z);
        let half_width = vec2(a.w, b.w) * width_scale(view.lens, b.xy - a.xy);
        return Ribbon(a.xy, b.xy, half_width, nearness, vec2(0.0, 1.0), scale_of(view.lens, nearness), tilt, true);
    }
    var ribbon = project(end_of(a), end_of(b), view.lens);
    ribbon.tilt = select(tilt, vec2(0.0), vec2(a.w < 0.0, b.w < 0.0));
    return clip(ribbon, view.lens, vec2<f32>(view.size), margin_of(ribbon.half_width));
}

fn paint_at(vertex: u32) -> vec4<f32> {
    let paint = paints[vertex];
    return vec4(unpack2x16float(paint.x), unpack2x16float(paint.y));
}

fn paint_of(segment: Segment) -> Paint {
    return Paint(paint_at(segment.start), paint_at(segment.end));
}
