// The segments of all sections on the screen: what `hair.render.tile_points` has left.

import package::line::Paint;
import package::ribbon::{End, Ribbon, clip, margin_of, off_screen, project, scale_of, width_scale};
import package::screen::{distance_of, view};

struct Vertex {
    // Its pixel and nearness; where it is not beyond the near plane, or far outside of the picture, its point in the space of the eye.
    point: vec3<f32>,
    // Radius / w, or there its radius.
    radius: f32,
    // How the strand goes on, see `joint`.
    tilt: f32,
    is_in_eye_space: bool,
    // Whether the segment to the next vertex may be seen.
    leads_on: bool,
}

// Those that may be seen of a strand follow each other: `point`, and what `pack_rest` makes of the rest.
@group(0) @binding(2) var<storage, read> vertices: array<vec4<u32>>;
// Colour and opacity of each of them, as four half floats.
@group(0) @binding(3) var<storage, read> paints: array<vec2<u32>>;

// A word of a vertex: `leads_on`, `is_in_eye_space`, the lowest two bits of the radius, the tilt as a half float without its lowest four bits, and
// the other bits of the radius. Of it 6 bits of the exponent are stored, and 12 behind it.
const LEADS_ON: u32 = 1u;
const IS_IN_EYE_SPACE: u32 = 2u;
const TILT_BITS: u32 = 0xfff0u;
// The bits of a radius that are not stored.
const RADIUS_CUT: u32 = 11u;
// 1e-12 and 1.6e7: radii are stored between them.
const LEAST_RADIUS: u32 = 0x2b800000u;
const MOST_RADIUS: u32 = 0x4b7ff800u;

fn pack_rest(vertex: Vertex) -> u32 {
    let flags = select(0u, LEADS_ON, vertex.leads_on) | select(0u, IS_IN_EYE_SPACE, vertex.is_in_eye_space);
    let tilt = pack2x16float(vec2(vertex.tilt, 0.0)) & TILT_BITS;
    let bits = clamp(bitcast<u32>(vertex.radius), LEAST_RADIUS, MOST_RADIUS) - LEAST_RADIUS;
    let radius = (bits + (1u << (RADIUS_CUT - 1u))) >> RADIUS_CUT;
    return flags | tilt | ((radius & 3u) << 2u) | ((radius >> 2u) << 16u);
}

fn unpack_vertex(packed: vec4<u32>) -> Vertex {
    let rest = packed.w;
    let tilt = unpack2x16float(rest & TILT_BITS).x;
    let radius = ((rest >> 16u) << 2u) | extractBits(rest, 2u, 2u);
    let bits = (radius << RADIUS_CUT) + LEAST_RADIUS;
    return Vertex(bitcast<vec3<f32>>(packed.xyz), bitcast<f32>(bits), tilt, (rest & IS_IN_EYE_SPACE) != 0u, (rest & LEADS_ON) != 0u);
}

fn leads_on(vertex: u32) -> bool {
    return (vertices[vertex].w & LEADS_ON) != 0u;
}

// A vertex before the eye again.
fn end_of(vertex: Vertex) -> End {
    let point = vertex.point;
    if vertex.is_in_eye_space {
        return End(point, vertex.radius);
    }
    let scale = scale_of(view.lens, point.zz).x;
    let across = off_screen(view.lens, point.xy - view.lens.center) / scale;
    return End(vec3(across, -distance_of(point.z)), vertex.radius / scale);
}

// The segment from a vertex on that leads on: of such a one both vertices are sound.
fn ribbon_of(start: u32) -> Ribbon {
    let a = unpack_vertex(vertices[start]);
    let b = unpack_vertex(vertices[start + 1u]);
    let tilt = vec2(a.tilt, b.tilt);
    let is_in_eye_space = vec2(a.is_in_eye_space, b.is_in_eye_space);
    if !any(is_in_eye_space) {
        let nearness = vec2(a.point.z, b.point.z);
        let half_width = vec2(a.radius, b.radius) * width_scale(view.lens, a.point.xy, b.point.xy - a.point.xy);
        return Ribbon(a.point.xy, b.point.xy, half_width, nearness, vec2(0.0, 1.0), scale_of(view.lens, nearness), tilt, true);
    }
    var ribbon = project(end_of(a), end_of(b), view.lens);
    ribbon.tilt = select(tilt, vec2(0.0), is_in_eye_space);
    return clip(ribbon, view.lens, vec2<f32>(view.size), margin_of(ribbon.half_width));
}

fn color_of(vertex: u32) -> vec4<f32> {
    let paint = paints[vertex];
    return vec4(unpack2x16float(paint.x), unpack2x16float(paint.y));
}

fn paint_of(start: u32) -> Paint {
    return Paint(color_of(start), color_of(start + 1u));
}
