// The strands of a section before the lens of a view: what every technique that walks over them is given.

import package::line::Paint;
import package::ribbon::{End, Ribbon, clip, is_sound, project};
import package::screen::view;
import package::section::SectionUniform;

@group(0) @binding(1) var<uniform> section: SectionUniform;
@group(0) @binding(2) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> colors: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> thickness: array<f32>;

fn end_at(strand: u32, vertex: u32) -> End {
    let world = section.pose * vec4(positions[vertex * section.strands + strand].xyz, 1.0);
    let width = thickness[vertex * section.guides + strand % section.guides];
    return End((view.lens.to_eye * world).xyz, section.fibre_radius * mix(section.tip_width, 1.0, width));
}

fn paint_at(strand: u32, vertex: u32) -> vec4<f32> {
    let color = colors[vertex * section.strands + strand];
    return vec4(unpack2x16float(color.x), unpack2x16float(color.y));
}

// The segment from a vertex to the next.
fn ribbon_of(strand: u32, vertex: u32) -> Ribbon {
    let i = vertex * section.strands + strand;
    if !is_sound(positions[i].xyz) || !is_sound(positions[i + section.strands].xyz) {
        return Ribbon();
    }
    let ribbon = project(end_at(strand, vertex), end_at(strand, vertex + 1u), view.lens);
    return clip(ribbon, view.lens, vec2<f32>(view.size), max(ribbon.half_width.x, ribbon.half_width.y) + 2.0);
}

fn paint_of(strand: u32, vertex: u32) -> Paint {
    return Paint(paint_at(strand, vertex), paint_at(strand, vertex + 1u));
}
