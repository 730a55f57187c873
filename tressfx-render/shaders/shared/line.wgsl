// A ribbon on the pixels: the line through its middle, the pixels that it may touch, and what it leaves in one.

import package::coverage::{coverage, pixel_reach};
import package::fragment::{Fragment, OPAQUE};
import package::ribbon::{Ribbon, along};
import package::screen::{scene_nearness, view};

// Colour and opacity at the ends of a segment.
struct Paint {
    start: vec4<f32>,
    end: vec4<f32>,
}

// The square of a length in pixels: a shorter segment has no direction and leaves nothing.
const SHORTEST: f32 = 1e-12;

// The line through the middle of a ribbon.
struct Line {
    delta: vec2<f32>,
    square: f32,
    normal: vec2<f32>,
    reach: vec2<f32>,
}

fn line_of(ribbon: Ribbon) -> Line {
    let delta = ribbon.end - ribbon.start;
    let square = dot(delta, delta);
    let direction = delta * inverseSqrt(max(square, 1e-20));
    let normal = vec2(-direction.y, direction.x);
    return Line(delta, square, normal, pixel_reach(normal));
}

// Where along the ribbon a pixel is, 0 to 1 between its ends.
fn place_of(ribbon: Ribbon, line: Line, pixel: vec2<u32>) -> f32 {
    return dot(vec2<f32>(pixel) + 0.5 - ribbon.start, line.delta) / line.square;
}

// What the ribbon leaves in a pixel at `place` along it, wherever the scene is.
fn fragment_on(ribbon: Ribbon, line: Line, paint: Paint, pixel: vec2<u32>, place: f32) -> Fragment {
    let half_width = mix(ribbon.half_width.x, ribbon.half_width.y, place);
    let covered = coverage(dot(vec2<f32>(pixel) + 0.5 - ribbon.start, line.normal), half_width, line.reach);
    let color = mix(paint.start, paint.end, along(ribbon, place));
    let nearness = mix(ribbon.nearness.x, ribbon.nearness.y, place);
    return Fragment(color.rgb, nearness, u32(round(saturate(covered * color.a) * OPAQUE)));
}

// What the ribbon leaves in a pixel: nothing unless the pixel's centre lies between its ends, half-open, so that the
// segments of a straight strand share no pixel; and nothing behind the scene.
fn fragment_at(ribbon: Ribbon, line: Line, paint: Paint, pixel: vec2<u32>) -> Fragment {
    let place = place_of(ribbon, line, pixel);
    if place < 0.0 || place >= 1.0 {
        return Fragment();
    }
    let scene = scene_nearness(pixel);
    var fragment = fragment_on(ribbon, line, paint, pixel, place);
    fragment.alpha = select(fragment.alpha, 0u, fragment.nearness < scene);
    return fragment;
}

// The pixels that a ribbon may touch: columns along the axis that it follows most, and in each the rows around its middle.
struct Span {
    // Whether columns run down the screen instead of across.
    steep: bool,
    first_column: i32,
    last_column: i32,
    // Pixels along a row and along a column.
    size: vec2<i32>,
    start: vec2<f32>,
    slope: f32,
    half_height: f32,
}

fn span_of(ribbon: Ribbon, line: Line) -> Span {
    let steep = abs(line.delta.y) > abs(line.delta.x);
    let start = select(ribbon.start, ribbon.start.yx, steep);
    let end = select(ribbon.end, ribbon.end.yx, steep);
    let size = select(vec2<i32>(view.size), vec2<i32>(view.size.yx), steep);
    // Along a column, and along the ribbon beyond its ends.
    let extent = max(ribbon.half_width.x, ribbon.half_width.y) + line.reach.x;
    let across = select(abs(line.normal), abs(line.normal.yx), steep);
    let overhang = extent * across.x;
    let first = max(i32(ceil(min(start.x, end.x) - overhang - 0.5)), 0);
    let last = min(i32(floor(max(start.x, end.x) + overhang - 0.5)), size.x - 1);
    return Span(steep, first, last, size, start, (end.y - start.y) / (end.x - start.x), extent / across.y);
}

// The row, not rounded, that the middle of the ribbon is at in a column.
fn middle_of(span: Span, column: i32) -> f32 {
    return span.start.y + span.slope * (f32(column) + 0.5 - span.start.x) - 0.5;
}

fn is_drawn(ribbon: Ribbon, line: Line) -> bool {
    return ribbon.visible && line.square >= SHORTEST;
}
