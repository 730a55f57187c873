// Segments are referred to from the slices of the tiles that they touch. It runs to count the references of each bin, and, once
// each bin has its place, to store them; where there is no room for all of them, those of some tiles in each round. It is the same
// code each time, compiled once, so that a compiler cannot round it differently: a bin gets exactly what was counted for it. One
// thread a vertex, for the segment that begins there.

import package::blocks::{BLOCK_EDGE, Blocks, block_at, is_hidden_in};
import package::grid::{GROUP, thread_index};
import package::line::{Line, Span, is_drawn, line_of, middle_of, span_of};
import package::ribbon::Ribbon;
import package::screen::{DISTANCE_MARGIN, distance_of, tile_columns, tile_count, view};
import package::segments::{leads_on, ribbon_of};
import package::tile::TILE;
import package::tiles::{FIRST_QUARTER, IS_NEAREST, REACHES_ON, STRIDE, TileInfo, ViewState, begin_of, slice_of, tiles};

@group(0) @binding(4) var<storage, read_write> state: ViewState;
@group(0) @binding(6) var<storage, read> infos: array<TileInfo>;
// A slice after the other: a number a tile. References while they are counted, then the place of the next one.
@group(0) @binding(7) var<storage, read_write> bins: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> references: array<u32>;
@group(0) @binding(13) var<storage, read> blocks: Blocks;

// Pixels by which a part of a ribbon is taken larger than it is: more than rounding can move a fragment.
const PIXEL_MARGIN: f32 = 0.02;

fn refer(bin: u32, reference: u32) {
    if tiles.stores == 0u {
        atomicAdd(&bins[bin], 1u);
        return;
    }
    let place = atomicAdd(&bins[bin], 1u) - tiles.first;
    if place < tiles.capacity {
        references[place] = reference;
    }
}

// How far along a ribbon columns lead, as a share of it.
struct Reach {
    // From one column to the next.
    of_column: f32,
    // From the middle of the ribbon to the pixels of the column beside it.
    beside: f32,
}

fn reach_of(line: Line, span: Span) -> Reach {
    let along = select(line.delta, line.delta.yx, span.steep);
    let of_column = 1.0 / along.x;
    return Reach(of_column, (span.half_height + PIXEL_MARGIN) * abs(along.y) * line.per_length * line.per_length + PIXEL_MARGIN * abs(of_column));
}

// Nearness of the farthest and of the nearest fragment that a ribbon may leave in columns.
fn range_of(ribbon: Ribbon, span: Span, reach: Reach, columns: vec2<i32>) -> vec2<f32> {
    let at = (vec2<f32>(columns) + 0.5 - span.start.x) * reach.of_column;
    let part = clamp(vec2(min(at.x, at.y) - reach.beside, max(at.x, at.y) + reach.beside), vec2(0.0), vec2(1.0));
    let ends = mix(ribbon.nearness.xx, ribbon.nearness.yy, part);
    return vec2(min(ends.x, ends.y), max(ends.x, ends.y));
}

// Distances of the nearest and the farthest, a little more than they are apart.
fn distances_of(nearness: vec2<f32>) -> vec2<f32> {
    let distance = vec2(distance_of(nearness.y), distance_of(nearness.x));
    var margin = DISTANCE_MARGIN * distance;
    if view.lens.is_perspective == 0u {
        margin = vec2(DISTANCE_MARGIN / view.lens.nearness_slope);
    }
    return vec2(distance.x - margin.x, distance.y + margin.y);
}

// No rows: the last is before the first, and others can be joined to it.
const NO_ROWS: vec2<i32> = vec2(0x7fffffff, -1);

// Rows that a ribbon may touch in columns: the first and the last.
fn rows_of(span: Span, columns: vec2<i32>) -> vec2<i32> {
    let middles = vec2(middle_of(span, columns.x), middle_of(span, columns.y));
    let reach = span.half_height + PIXEL_MARGIN;
    let first = max(i32(ceil(min(middles.x, middles.y) - reach)), 0);
    let last = min(i32(floor(max(middles.x, middles.y) + reach)), span.size.y - 1);
    return select(vec2(first, last), NO_ROWS, columns.x > columns.y || first > last);
}

// The quarters of a tile that columns of the ribbon touch: bits of a reference.
fn quarters_of(span: Span, columns: vec2<i32>, tile_column: i32, row: i32) -> u32 {
    let edge = i32(TILE);
    let middle = tile_column * edge + edge / 2;
    let first = rows_of(span, vec2(columns.x, min(columns.y, middle - 1)));
    let second = rows_of(span, vec2(max(columns.x, middle), columns.y));
    let begins = row * edge + vec4(0, edge / 2, 0, edge / 2);
    let firsts = vec4(first.xx, second.xx);
    let lasts = vec4(first.yy, second.yy);
    let is_touched = vec4<u32>(firsts <= min(lasts, begins + edge / 2 - 1)) * vec4<u32>(lasts >= begins);
    let places = select(vec4(0u, 2u, 1u, 3u), vec4(0u, 1u, 2u, 3u), span.steep);
    let bits = is_touched << places;
    return (bits.x | bits.y | bits.z | bits.w) * FIRST_QUARTER;
}

// Whether a ribbon touches no block with a tile that is drawn again, or is hidden in all of them.
fn is_hidden(ribbon: Ribbon, span: Span) -> bool {
    let edge = i32(BLOCK_EDGE);
    let nearest = max(ribbon.nearness.x, ribbon.nearness.y) * (1.0 + DISTANCE_MARGIN);
    let rows = rows_of(span, vec2(span.first_column, span.last_column));
    for (var column = span.first_column / edge; column * edge <= span.last_column; column++) {
        for (var row = rows.x / edge; row * edge <= rows.y; row++) {
            let place = vec2<u32>(select(vec2(column, row), vec2(row, column), span.steep));
            if !is_hidden_in(blocks.words[block_at(place)], nearest) {
                return false;
            }
        }
    }
    return true;
}

fn bin_column(ribbon: Ribbon, span: Span, reach: Reach, tile_column: i32, vertex: u32) {
    let edge = i32(TILE);
    let columns = vec2(max(span.first_column, tile_column * edge), min(span.last_column, tile_column * edge + edge - 1));
    let rows = rows_of(span, columns);
    if rows.x > rows.y {
        return;
    }
    let nearness = range_of(ribbon, span, reach, columns);
    let distances = distances_of(nearness);
    for (var row = rows.x / edge; row <= rows.y / edge; row++) {
        let place = vec2<u32>(select(vec2(tile_column, row), vec2(row, tile_column), span.steep));
        let tile = place.y * tile_columns() + place.x;
        let info = infos[tile];
        if nearness.y * (1.0 + DISTANCE_MARGIN) < info.farthest {
            continue;
        }
        if tiles.stores == 1u && (info.first < tiles.first || info.first >= tiles.end) {
            // The tile has its references in another round.
            continue;
        }
        let begin = begin_of(info.nearest);
        let last = slice_of(begin, distances.y);
        var reference = 0u;
        if tiles.stores == 1u {
            reference = vertex | quarters_of(span, columns, tile_column, row);
        }
        var flag = IS_NEAREST;
        for (var slice = slice_of(begin, distances.x); slice <= last; slice += STRIDE) {
            refer(slice * tile_count() + tile, reference | flag | select(0u, REACHES_ON, slice < last));
            flag = 0u;
        }
    }
}

@compute @workgroup_size(GROUP)
fn tile_bin(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
            @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if i >= min(atomicLoad(&state.counters.vertices), tiles.vertices) || !leads_on(i) {
        return;
    }
    let ribbon = ribbon_of(i);
    let line = line_of(ribbon);
    if !is_drawn(ribbon, line) {
        return;
    }
    let span = span_of(ribbon, line);
    if blocks.are_drawn_again == 1u && is_hidden(ribbon, span) {
        return;
    }
    let edge = i32(TILE);
    let reach = reach_of(line, span);
    for (var column = span.first_column / edge; column * edge <= span.last_column; column++) {
        bin_column(ribbon, span, reach, column, i);
    }
}
