// How much light fibres take in each cell: the area that they cover as the light sees it, by their `shadow_alpha`. One thread a segment, of
// an even sample of the strands; those of a strand share the work on the skin behind its root. Sums are of integers, the same in any order.

import package::frames::{SKY, ShadowGrid, ShadowFrameUniform, cell_at, in_frame, place_in, shrinks_by};
import package::grid::{GROUP, thread_index};
import package::grids::{grid_of, shadow};
import package::hash::hash;
import package::ribbon::is_sound;
import package::section::{SectionUniform, moved_aside, source_of, stepped, strands_of};

@group(0) @binding(0) var<uniform> section: SectionUniform;
@group(0) @binding(1) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> thickness: array<f32>;
@group(0) @binding(3) var<storage, read_write> cells: array<atomic<u32>>;

// What an optical depth of 1 is counted as.
const UNIT: f32 = 4096.0;
// No more than this at once.
const MOST: f32 = 1e8;
// A cell with skin in it.
const SKIN: u32 = 0x80000000u;
// Cells that a segment is divided into at most.
const MAX_STEPS: f32 = 512.0;
// Mean of the sine of the angle between a fibre and a direction, over all directions.
const MEAN_SINE: f32 = 0.785398163;
// Radius of the largest ball of skin, in cells.
const MAX_SKIN: f32 = 3.0;

// A vertex of a strand in the world, and whether it is one.
fn posed(source: u32, vertex: u32, aside: vec3<f32>) -> vec4<f32> {
    let local = positions[vertex * section.strands + source].xyz;
    return vec4((section.pose * vec4(local + aside, 1.0)).xyz, select(0.0, 1.0, is_sound(local)));
}

fn width_at(strand: u32, vertex: u32) -> f32 {
    let share = thickness[vertex * section.guides + strand % section.guides];
    return 2.0 * section.fibre_radius * mix(section.tip_width, 1.0, share);
}

// A straight piece as a frame sees it, and how much light it takes for each unit of its length there.
struct Piece {
    start: vec3<f32>,
    end: vec3<f32>,
    taken: f32,
}

fn spread(grid: ShadowGrid, piece: Piece, length: f32, salt: u32) {
    let start = place_in(grid, piece.start);
    let way = place_in(grid, piece.end) - start;
    let steps = clamp(ceil(max(max(abs(way.x), abs(way.y)), abs(way.z))), 1.0, MAX_STEPS);
    let each = min(UNIT * piece.taken * length / (grid.cell.x * grid.cell.y * steps), MOST);
    for (var step = 0u; step < u32(steps); step++) {
        let at = start + way * ((f32(step) + 0.5) / steps);
        // Rounded up as often as the rest says: nothing is lost where a segment is short.
        let count = u32(each + hash(salt + step));
        if count > 0u {
            atomicAdd(&cells[cell_at(grid, vec3<i32>(floor(at)))], count);
        }
    }
}

// A root in the world, which way its strand grows there, and how many roots share the skin.
struct Root {
    at: vec3<f32>,
    growth: vec3<f32>,
    roots: f32,
}

// No roots share the skin where there is none behind this strand: only guides stand for it.
fn root_of(strand: u32, source: u32, aside: vec3<f32>) -> Root {
    if strand >= section.guides {
        return Root();
    }
    let samples = min(section.shadow_strands, shadow.samples);
    let start = posed(source, 0u, aside);
    let next = posed(source, stepped(section.lod, 1u, section.vertices), aside);
    let growth = next.xyz - start.xyz;
    let unit = growth * inverseSqrt(max(dot(growth, growth), 1e-30));
    return Root(start.xyz, unit, select(0.0, f32(min(section.guides, samples)), start.w * next.w > 0.0));
}

// Cells of a ball of skin behind a root, large enough that those of neighbouring roots touch: every `threads`th of the box around it.
fn add_skin(grid: ShadowGrid, frame: ShadowFrameUniform, root: Root, thread: u32, threads: u32) {
    let at = in_frame(frame, root.at);
    let unit = vec3(vec2(shrinks_by(frame, at)), 1.0) * grid.cell;
    let extent = vec3<f32>(grid.size) * unit;
    let spacing = sqrt(2.0 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x) / root.roots);
    let radius = clamp(spacing, unit.x, MAX_SKIN * unit.x);
    let middle = vec3<i32>(floor(place_in(grid, in_frame(frame, root.at - root.growth * (radius + max(unit.x, unit.z))))));
    let reach = vec3<u32>(ceil(radius / unit));
    let size = 2u * reach + 1u;
    for (var cell = thread; cell < size.x * size.y * size.z; cell += threads) {
        let place = vec3(cell % size.x, cell / size.x % size.y, cell / (size.x * size.y));
        let step = vec3<i32>(place) - vec3<i32>(reach);
        let off = vec3<f32>(step) * unit;
        if dot(off, off) <= radius * radius {
            atomicOr(&cells[cell_at(grid, middle + step)], SKIN);
        }
    }
}

@compute @workgroup_size(GROUP)
fn shadow_splat(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    let samples = min(section.shadow_strands, shadow.samples);
    if i >= samples * (section.lod.vertices - 1u) {
        return;
    }
    let strand = i % samples;
    let segment = i / samples;
    let source = source_of(section.strands, strand);
    let aside = moved_aside(section.strands, section.copy_spread, strand);
    let vertices = vec2(stepped(section.lod, segment, section.vertices), stepped(section.lod, segment + 1u, section.vertices));
    let start = posed(source, vertices.x, aside);
    let end = posed(source, vertices.y, aside);
    let width = 0.5 * (width_at(strand, vertices.x) + width_at(strand, vertices.y));
    let taken = section.shadow_alpha * width * strands_of(section.lod) / f32(samples);
    let root = root_of(strand, source, aside);
    for (var index = shadow.first; index < shadow.end; index++) {
        let frame = shadow.frames[index];
        let grid = grid_of(index);
        if start.w * end.w > 0.0 {
            let ends = array(in_frame(frame, start.xyz), in_frame(frame, end.xyz));
            let piece = Piece(ends[0], ends[1], taken / shrinks_by(frame, 0.5 * (ends[0] + ends[1])));
            let seen = length(ends[1].xy - ends[0].xy);
            let covered = select(seen, MEAN_SINE * distance(ends[0], ends[1]), frame.kind == SKY);
            spread(grid, piece, covered, (index * section.vertices + vertices.x) * 65536u + strand * 3u);
        }
        if root.roots > 0.0 && frame.has_skin != 0u {
            add_skin(grid, frame, root, segment, section.lod.vertices - 1u);
        }
    }
}
