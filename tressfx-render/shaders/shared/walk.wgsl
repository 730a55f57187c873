// The walk of a segment over the pixels that it covers. Data-centre GPUs have few raster units, and hair is thinner than
// the triangles that they were made for: so the segment finds its own pixels. What becomes of a fragment is up to the
// technique: it brings a module `sink` with a struct `Sink` and a function `take(sink, pixel, fragment)`.

import package::coverage::{coverage, pixel_reach};
import package::fragment::{Fragment, OPAQUE};
import package::ribbon::{Ribbon, along};
import package::sink::{Sink, take};
import package::strands::{Paint, scene_depth, view};

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

// What the ribbon leaves in a pixel: nothing unless the pixel's centre lies between its ends, half-open, so that the
// segments of a straight strand share no pixel.
fn fragment_at(ribbon: Ribbon, line: Line, paint: Paint, pixel: vec2<u32>) -> Fragment {
    let offset = vec2<f32>(pixel) + 0.5 - ribbon.start;
    let t = dot(offset, line.delta) / line.square;
    if t < 0.0 || t >= 1.0 {
        return Fragment();
    }
    let half_width = mix(ribbon.half_width.x, ribbon.half_width.y, t);
    let covered = coverage(dot(offset, line.normal), half_width, line.reach);
    let color = mix(paint.start, paint.end, along(ribbon, view.lens, t));
    let nearness = mix(ribbon.nearness.x, ribbon.nearness.y, t);
    let depth = textureLoad(scene_depth, pixel + view.offset, 0);
    let scene = (depth - view.lens.depth_offset) * view.lens.depth_scale;
    let alpha = u32(round(saturate(covered * color.a) * OPAQUE));
    return Fragment(color.rgb, nearness, select(alpha, 0u, nearness < scene));
}

// Visits the pixels that the ribbon may touch, column by column along the axis that it follows most.
fn walk(ribbon: Ribbon, paint: Paint, sink: ptr<function, Sink>) {
    let line = line_of(ribbon);
    if !ribbon.visible || line.square < SHORTEST {
        return;
    }
    let steep = abs(line.delta.y) > abs(line.delta.x);
    let start = select(ribbon.start, ribbon.start.yx, steep);
    let end = select(ribbon.end, ribbon.end.yx, steep);
    let size = select(vec2<i32>(view.size), vec2<i32>(view.size.yx), steep);
    // Along a column, and along the ribbon beyond its ends.
    let extent = max(ribbon.half_width.x, ribbon.half_width.y) + line.reach.x;
    let across = select(abs(line.normal), abs(line.normal.yx), steep);
    let half_height = extent / across.y;
    let overhang = extent * across.x;
    let slope = (end.y - start.y) / (end.x - start.x);
    let last_column = min(i32(floor(max(start.x, end.x) + overhang - 0.5)), size.x - 1);
    for (var column = max(i32(ceil(min(start.x, end.x) - overhang - 0.5)), 0); column <= last_column; column++) {
        let middle = start.y + slope * (f32(column) + 0.5 - start.x) - 0.5;
        let last_row = min(i32(floor(middle + half_height)), size.y - 1);
        for (var row = max(i32(ceil(middle - half_height)), 0); row <= last_row; row++) {
            let pixel = vec2<u32>(select(vec2(column, row), vec2(row, column), steep));
            let fragment = fragment_at(ribbon, line, paint, pixel);
            if fragment.alpha > 0u {
                take(sink, pixel, fragment);
            }
        }
    }
}
