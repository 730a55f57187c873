// A quad over a segment: the raster units visit the pixels that the walk visits, and some more.

import package::fragment::Fragment;
import package::line::{Paint, fragment_at, has_ends_of, is_drawn, line_of, overshoot};
import package::listed::segment_of;
import package::ribbon::{Ribbon, scale_of, slant_of};
import package::screen::view;
import package::strands::{paint_of, ribbon_of, section, strand_at};

// Pixels by which a quad is larger than what its ribbon can cover: more than coordinates round to.
const MARGIN: f32 = 0.25;

// A ribbon and its paint, from the vertices of a quad to its fragments.
struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) ends: vec4<f32>,
    @location(1) @interpolate(flat) half_width_and_nearness: vec4<f32>,
    @location(2) @interpolate(flat) part_and_tilt: vec4<f32>,
    @location(3) @interpolate(flat) paint_start: vec4<f32>,
    @location(4) @interpolate(flat) paint_end: vec4<f32>,
    @location(5) @interpolate(flat) slant: f32,
}

// Six vertices a segment, two triangles.
fn corner_of(vertex: u32) -> Corner {
    let segment = segment_of(vertex / 6u);
    let strand = strand_at(segment % section.lod.strands);
    let ribbon = ribbon_of(strand, segment / section.lod.strands);
    let line = line_of(ribbon);
    if !is_drawn(ribbon, line) {
        // All corners in one point: nothing is drawn.
        return Corner(vec4(0.0, 0.0, 0.0, 1.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), 0.0);
    }
    let paint = paint_of(strand, segment / section.lod.strands);
    let direction = vec2(line.normal.y, -line.normal.x);
    let extent = max(ribbon.half_width.x, ribbon.half_width.y) + line.reach.x + MARGIN;
    let beyond = overshoot(ribbon, extent) + MARGIN;
    // Corners 0 1 2 and 2 1 3, two bits each: along the ribbon and across.
    let corner = (0xda4u >> (2u * (vertex % 6u))) & 3u;
    let end = select(ribbon.start - beyond.x * direction, ribbon.end + beyond.y * direction, (corner & 1u) == 1u);
    let pixel = end + line.normal * select(-extent, extent, corner > 1u) + vec2<f32>(view.offset);
    let clip = pixel / vec2<f32>(view.target_size) * 2.0 - 1.0;
    return Corner(
        vec4(clip.x, -clip.y, 0.0, 1.0),
        vec4(ribbon.start, ribbon.end),
        vec4(ribbon.half_width, ribbon.nearness),
        vec4(ribbon.part, ribbon.tilt),
        paint.start,
        paint.end,
        slant_of(view.lens, ribbon),
    );
}

// The pixel of the view.
fn pixel_of(corner: Corner) -> vec2<u32> {
    return vec2<u32>(corner.position.xy) - view.offset;
}

// What the walk finds in that pixel. The scene hides it here, before it is kept: the test of the hardware would come too late.
// Without an attribute that WebGPU does not have, it comes after a fragment shader that writes buffers.
fn fragment_of(corner: Corner) -> Fragment {
    let pixel = pixel_of(corner);
    if any(pixel >= view.size) {
        return Fragment();
    }
    let widths = corner.half_width_and_nearness;
    let scale = scale_of(view.lens, widths.zw);
    let joints = corner.part_and_tilt;
    let ribbon = Ribbon(corner.ends.xy, corner.ends.zw, widths.xy, widths.zw, joints.xy, scale, joints.zw, true);
    return fragment_at(ribbon, line_of(ribbon), corner.slant, Paint(corner.paint_start, corner.paint_end), pixel, has_ends_of(ribbon));
}
