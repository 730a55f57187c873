// The segments of all sections on the screen: what `hair.render.tile_points` has left.

import package::line::Paint;
import package::ribbon::{End, Ribbon, clip, is_sound, margin_of, project, scale_of, width_scale};
import package::screen::view;
import package::tiles::distance_of;

struct Vertex {
    // Its pixel, nearness, and radius / w. Where it is not beyond the near plane: its point in the space of the eye, and its radius
    // below 0.
    point: vec4<f32>,
    // Colour and opacity of the surface there, as four half floats.
    color: vec2<u32>,
    // How the strand goes on, see `joint`.
    tilt: f32,
    // 1 where the segment to the next vertex may be seen, else 0.
    leads_on: u32,
}

// Those that may be seen of a strand follow each other.
@group(0) @binding(2) var<storage, read> vertices: array<Vertex>;

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

// The segment from a vertex on.
fn ribbon_of(start: u32) -> Ribbon {
    let a = vertices[start].point;
    let b = vertices[start + 1u].point;
    if !is_sound(a.xyz) || !is_sound(b.xyz) {
        return Ribbon();
    }
    let tilt = vec2(vertices[start].tilt, vertices[start + 1u].tilt);
    if min(a.w, b.w) >= 0.0 && all(max(abs(a.xy), abs(b.xy)) < vec2(LARGEST_PIXEL)) {
        let nearness = vec2(a.z, b.z);
        let half_width = vec2(a.w, b.w) * width_scale(view.lens, b.xy - a.xy);
        return Ribbon(a.xy, b.xy, half_width, nearness, vec2(0.0, 1.0), scale_of(view.lens, nearness), tilt, true);
    }
    var ribbon = project(end_of(a), end_of(b), view.lens);
    ribbon.tilt = select(tilt, vec2(0.0), vec2(a.w < 0.0, b.w < 0.0));
    return clip(ribbon, view.lens, vec2<f32>(view.size), margin_of(ribbon.half_width));
}

fn color_of(vertex: u32) -> vec4<f32> {
    let color = vertices[vertex].color;
    return vec4(unpack2x16float(color.x), unpack2x16float(color.y));
}

fn paint_of(start: u32) -> Paint {
    return Paint(color_of(start), color_of(start + 1u));
}
