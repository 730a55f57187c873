// The strands of a section before the lens of a view: what every technique that walks over them is given. Strands and vertices are numbered as
// they are drawn: see `lod`.

import package::joint::{ROUND, tilt_of};
import package::line::Paint;
import package::ribbon::{End, Ribbon, clip, is_sound, margin_of, on_screen, project, scale_at};
import package::screen::view;
import package::section::{SectionUniform, faded, moved_aside, source_of, stepped};

@group(0) @binding(1) var<uniform> section: SectionUniform;
@group(0) @binding(2) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> colors: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> thickness: array<f32>;

// A strand or a copy.
@if(copies)
struct Strand {
    number: u32,
    // In the buffers, and how far it is moved away from there.
    index: u32,
    aside: vec3<f32>,
}

// Without copies it is its number: what more were kept would take registers from kernels that have none left.
@if(!copies)
alias Strand = u32;

fn strand_at(number: u32) -> Strand {
    @if(copies) {
        let aside = moved_aside(section.strands, section.copy_spread, number);
        return Strand(number, source_of(section.strands, number), aside);
    }
    @if(!copies) { return number; }
}

fn number_of(strand: Strand) -> u32 {
    @if(copies) { return strand.number; }
    @if(!copies) { return strand; }
}

fn index_of(strand: Strand) -> u32 {
    @if(copies) { return strand.index; }
    @if(!copies) { return strand; }
}

// A position of the buffers.
fn placed(strand: Strand, position: vec4<f32>) -> vec3<f32> {
    @if(copies) { return position.xyz + strand.aside; }
    @if(!copies) { return position.xyz; }
}

// The vertex of the buffers.
fn full_vertex(vertex: u32) -> u32 {
    return stepped(section.lod, vertex, section.vertices);
}

// Where a vertex of a strand or of a copy is in the buffers.
fn vertex_of(strand: Strand, vertex: u32) -> u32 {
    return full_vertex(vertex) * section.strands + index_of(strand);
}

fn is_sound_at(strand: Strand, vertex: u32) -> bool {
    return is_sound(positions[vertex_of(strand, vertex)].xyz);
}

// A vertex in the space of the eye.
fn point_at(strand: Strand, vertex: u32) -> vec3<f32> {
    let world = section.pose * vec4(placed(strand, positions[vertex_of(strand, vertex)]), 1.0);
    return (view.lens.to_eye * world).xyz;
}

fn radius_at(strand: Strand, vertex: u32) -> f32 {
    let width = thickness[full_vertex(vertex) * section.guides + index_of(strand) % section.guides];
    return section.fibre_radius * faded(section.lod, number_of(strand)) * mix(section.tip_width, 1.0, width);
}

fn end_at(strand: Strand, vertex: u32) -> End {
    return End(point_at(strand, vertex), radius_at(strand, vertex));
}

// Three points of a strand that follow each other, in the space of the eye.
struct Bend {
    before: vec3<f32>,
    middle: vec3<f32>,
    after: vec3<f32>,
}

fn pixel_at(point: vec3<f32>) -> vec2<f32> {
    return on_screen(view.lens, point.xy, scale_at(view.lens, -point.z));
}

// The tilt at the middle one. What reaches through the near plane goes straight on.
fn tilt_between(bend: Bend) -> f32 {
    if min(min(-bend.before.z, -bend.middle.z), -bend.after.z) <= view.lens.near {
        return 0.0;
    }
    let middle = pixel_at(bend.middle);
    return tilt_of(middle - pixel_at(bend.before), pixel_at(bend.after) - middle);
}

fn color_of(strand: Strand, vertex: u32) -> vec4<f32> {
    let color = colors[vertex_of(strand, vertex)];
    return vec4(unpack2x16float(color.x), unpack2x16float(color.y));
}

// The vertices before and after one; where no segment leads to it or from it, the vertex itself.
fn neighbours_of(strand: Strand, vertex: u32) -> vec2<u32> {
    let last = section.lod.vertices - 1u;
    let near = vec2(max(vertex, 1u) - 1u, min(vertex + 1u, last));
    return select(vec2(vertex), near, vec2(is_sound_at(strand, near.x), is_sound_at(strand, near.y)));
}

fn bend_at(strand: Strand, vertex: u32, beside: vec2<u32>) -> Bend {
    return Bend(point_at(strand, beside.x), point_at(strand, vertex), point_at(strand, beside.y));
}

// A segment with what is before and after it: each of its four points is looked up once.
struct Stretch {
    vertices: vec4<u32>,
    start: Bend,
    end: Bend,
}

fn stretch_of(strand: Strand, vertex: u32) -> Stretch {
    let first = neighbours_of(strand, vertex).x;
    let last = neighbours_of(strand, vertex + 1u).y;
    let start = Bend(point_at(strand, first), point_at(strand, vertex), point_at(strand, vertex + 1u));
    let end = Bend(start.middle, start.after, point_at(strand, last));
    return Stretch(vec4(first, vertex, vertex + 1u, last), start, end);
}

// The segment from a vertex to the next.
fn ribbon_of(strand: Strand, vertex: u32) -> Ribbon {
    if !is_sound_at(strand, vertex) || !is_sound_at(strand, vertex + 1u) {
        return Ribbon();
    }
    let stretch = stretch_of(strand, vertex);
    let start = End(stretch.start.middle, radius_at(strand, vertex));
    var ribbon = project(start, End(stretch.end.middle, radius_at(strand, vertex + 1u)), view.lens);
    let joints = vec2(tilt_between(stretch.start), tilt_between(stretch.end));
    let tilt = select(joints, vec2(ROUND), stretch.vertices.xw == stretch.vertices.yz);
    // What the near plane has cut has no joint there.
    ribbon.tilt = select(tilt, vec2(0.0), vec2(ribbon.part.x > 0.0, ribbon.part.y < 1.0));
    return clip(ribbon, view.lens, vec2<f32>(view.size), margin_of(ribbon.half_width));
}

fn paint_of(strand: Strand, vertex: u32) -> Paint {
    return Paint(color_of(strand, vertex), color_of(strand, vertex + 1u));
}
