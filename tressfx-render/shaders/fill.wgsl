// Strands become fragments, one thread a segment. Data-centre GPUs have few raster units, and hair is thinner than the
// triangles that they were made for: so the segment finds its own pixels.

import package::coverage::{coverage, pixel_reach};
import package::fragment::{Counters, OPAQUE, pack_node};
import package::frame::Frame;
import package::grid::{GROUP, thread_index};
import package::ribbon::{End, Ribbon, along, clip, is_sound, project};
import package::section::Section;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> section: Section;
@group(0) @binding(2) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> colors: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> thickness: array<f32>;
@group(0) @binding(5) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> nodes: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read_write> counters: Counters;
@group(0) @binding(8) var scene_depth: texture_depth_2d;

// One request to the pool a group instead of one a fragment: everybody waits for that counter.
var<workgroup> requested: atomic<u32>;
var<workgroup> granted: u32;

struct Paint {
    start: vec4<f32>,
    end: vec4<f32>,
}

fn end_at(strand: u32, vertex: u32) -> End {
    let world = section.pose * vec4(positions[vertex * section.strands + strand].xyz, 1.0);
    let width = thickness[vertex * section.guides + strand % section.guides];
    return End((frame.view * world).xyz, section.fibre_radius * mix(section.tip_width, 1.0, width));
}

fn paint_at(strand: u32, vertex: u32) -> vec4<f32> {
    let color = colors[vertex * section.strands + strand];
    return vec4(unpack2x16float(color.x), unpack2x16float(color.y));
}

fn ribbon_of(strand: u32, vertex: u32) -> Ribbon {
    let i = vertex * section.strands + strand;
    if !is_sound(positions[i].xyz) || !is_sound(positions[i + section.strands].xyz) {
        return Ribbon();
    }
    let size = vec2<f32>(frame.size);
    let ribbon = project(end_at(strand, vertex), end_at(strand, vertex + 1u), frame.near, frame.focal, 0.5 * size);
    return clip(ribbon, size, max(ribbon.half_width.x, ribbon.half_width.y) + 2.0);
}

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

struct Fragment {
    color: vec3<f32>,
    nearness: f32,
    // In units of 1 / 65535; 0 is no fragment.
    alpha: u32,
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
    let color = mix(paint.start, paint.end, along(ribbon, t));
    let nearness = mix(ribbon.nearness.x, ribbon.nearness.y, t);
    let scene = (textureLoad(scene_depth, pixel, 0) - frame.depth_offset) * frame.depth_scale;
    let alpha = u32(round(saturate(covered * color.a) * OPAQUE));
    return Fragment(color.rgb, nearness, select(alpha, 0u, nearness < scene));
}

// Puts a fragment at the head of its pixel's list. One that has no room leaves the list as it is.
fn store(node: u32, pixel: vec2<u32>, fragment: Fragment) {
    if node < frame.node_capacity {
        let next = atomicExchange(&heads[pixel.y * frame.size.x + pixel.x], node + 1u);
        nodes[node] = pack_node(fragment.nearness, fragment.color, fragment.alpha, next);
    }
}

// Visits the pixels that the ribbon may touch, column by column along the axis that it follows most. Returns the number
// of fragments. Those for which there is `room` go into the nodes from `first` on: never into more than were asked for, even
// if a compiler rounds the two walks of a thread differently. A node in two lists would close one of them to a ring.
fn walk(ribbon: Ribbon, paint: Paint, first: u32, room: u32) -> u32 {
    let line = line_of(ribbon);
    if !ribbon.visible || line.square < 1e-12 {
        return 0u;
    }
    let steep = abs(line.delta.y) > abs(line.delta.x);
    let start = select(ribbon.start, ribbon.start.yx, steep);
    let end = select(ribbon.end, ribbon.end.yx, steep);
    let size = select(vec2<i32>(frame.size), vec2<i32>(frame.size.yx), steep);
    // Along a column, and along the ribbon beyond its ends.
    let extent = max(ribbon.half_width.x, ribbon.half_width.y) + line.reach.x;
    let across = select(abs(line.normal), abs(line.normal.yx), steep);
    let half_height = extent / across.y;
    let overhang = extent * across.x;
    let slope = (end.y - start.y) / (end.x - start.x);
    let last_column = min(i32(floor(max(start.x, end.x) + overhang - 0.5)), size.x - 1);
    var count = 0u;
    for (var column = max(i32(ceil(min(start.x, end.x) - overhang - 0.5)), 0); column <= last_column; column++) {
        let middle = start.y + slope * (f32(column) + 0.5 - start.x) - 0.5;
        let last_row = min(i32(floor(middle + half_height)), size.y - 1);
        for (var row = max(i32(ceil(middle - half_height)), 0); row <= last_row; row++) {
            let pixel = vec2<u32>(select(vec2(column, row), vec2(row, column), steep));
            let fragment = fragment_at(ribbon, line, paint, pixel);
            if fragment.alpha > 0u {
                if count < room {
                    store(first + count, pixel, fragment);
                }
                count++;
            }
        }
    }
    return count;
}

@compute @workgroup_size(GROUP)
fn fill(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
        @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        atomicStore(&requested, 0u);
    }
    workgroupBarrier();
    let i = thread_index(group, groups, lane);
    var ribbon: Ribbon;
    var paint: Paint;
    if i < section.strands * (section.vertices - 1u) {
        let strand = i % section.strands;
        let vertex = i / section.strands;
        ribbon = ribbon_of(strand, vertex);
        paint = Paint(paint_at(strand, vertex), paint_at(strand, vertex + 1u));
    }
    let count = walk(ribbon, paint, 0u, 0u);
    let place = atomicAdd(&requested, count);
    workgroupBarrier();
    if lane == 0u {
        granted = atomicAdd(&counters.fragments, atomicLoad(&requested));
    }
    workgroupBarrier();
    walk(ribbon, paint, granted + place, count);
}
