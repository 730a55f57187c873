// The pixels of a tile, from front to back, one group a tile. It goes through the slices in units: as many slices as should
// fill the list of fragments. The fragments of a unit are sorted by pixel and depth, and blended; pixels that have become opaque take no more; the tile ends when all are closed.
//
// A fragment belongs to the slice of its own depth, so that a segment that is referred to from several slices leaves each
// fragment once. A unit with too many fragments blends nothing and is tried again with half of its slices, or half of the
// depths of its slice. Where fragments of one and the same depth are too many, their order means nothing: they are blended as
// their mean.

import package::counters::Counters;
import package::fragment::{Fragment, OPAQUE, depth_key, pack_color, packed_alpha, packed_color};
import package::line::{fragment_on, is_drawn, line_of, middle_of, place_of, span_of};
import package::screen::{scene_nearness, view};
import package::segments::{paint_of, ribbon_of, segment_from};
import package::sums::{mean_color, optical_depth, transmittance_of, weighted};
import package::tiles::{CLASSES, IS_NEAREST, SLICES, TILE, WaitingTile, WaitingTiles, begin_of, distance_of, parts_of, slice_of, tile_columns, tile_count, tiles};
import package::unit::{ENTRIES, FIRST_RATE, LAST_KEY, Unit, bounds, next_unit, unit_from};

@group(0) @binding(4) var<storage, read_write> counters: Counters;
// The end of each slice of each tile, a slice after the other.
@group(0) @binding(6) var<storage, read> bins: array<u32>;
@group(0) @binding(7) var<storage, read> queue: WaitingTiles;
@group(0) @binding(8) var<storage, read> references: array<u32>;
// Premultiplied colour and alpha as four half floats, a pixel.
@group(0) @binding(9) var<storage, read_write> resolved: array<vec2<u32>>;

const LANES: u32 = 256u;
// Lanes that share a segment: each has every second column of its pixels.
const SHARE: u32 = 2u;
const PIXELS: u32 = TILE * TILE;
const NO_TILE: u32 = 0xffffffffu;
// Fragments of a lane.
const OWN: u32 = (ENTRIES + LANES - 1u) / LANES;
// Keys by which a fragment may be out of the range of its ends.
const KEYS: u32 = 16u;
// The sums of a mean have room for so many fragments of a pixel of this brightness.
const MOST_IN_MEAN: u32 = 2048u;
const BRIGHTEST_IN_MEAN: f32 = 16.0;
const MEAN_UNIT: f32 = 65536.0;

// A tile, or a part of it.
struct Job {
    tile: WaitingTile,
    part: u32,
    // 0 where it is not its turn.
    parts: u32,
}

var<workgroup> job: Job;
// Distance at which the slices of the tile begin.
var<workgroup> begin: f32;
var<workgroup> plan: Unit;
// Fragments that were found in the unit, whether or not there was room for them.
var<workgroup> total: atomic<u32>;
var<workgroup> keys: array<u32, ENTRIES>;
var<workgroup> colors: array<vec2<u32>, ENTRIES>;
// Pixel and place among the fragments of the pixel.
var<workgroup> places: array<u32, ENTRIES>;
var<workgroup> counts: array<atomic<u32>, PIXELS>;
var<workgroup> starts: array<u32, PIXELS>;
// Optical depth, weight and colour of a mean; a pixel.
var<workgroup> sums: array<array<atomic<u32>, 5>, PIXELS>;
// Nearness of the scene.
var<workgroup> scene: array<f32, PIXELS>;
var<workgroup> rows: array<u32, TILE>;
// A bit a pixel that takes no more.
var<workgroup> closed: array<atomic<u32>, 2>;
var<workgroup> hairy_pixels: atomic<u32>;

// What lies before the hair that comes next.
struct Front {
    color: vec3<f32>,
    transmittance: f32,
}

// The work of a group: the heaviest comes first.
fn job_of(group: u32) -> Job {
    var rest = group;
    for (var i = CLASSES; i > 0u; i--) {
        let parts = parts_of(i - 1u);
        let size = queue.sizes[i - 1u];
        if rest < size * parts {
            let tile = queue.tiles[(i - 1u) * tile_count() + rest / parts];
            // A tile has its references in one round.
            let is_now = tile.first >= tiles.first && tile.first < tiles.end;
            return Job(tile, rest % parts, select(0u, parts, is_now));
        }
        rest -= size * parts;
    }
    return Job(WaitingTile(NO_TILE, 0u, 0.0, 0u), 0u, 1u);
}

fn add_to_mean(pixel: u32, fragment: Fragment) {
    if atomicAdd(&counts[pixel], 1u) >= MOST_IN_MEAN {
        return;
    }
    let color = weighted(min(fragment.color, vec3(BRIGHTEST_IN_MEAN)), fragment.alpha, MEAN_UNIT);
    atomicAdd(&sums[pixel][0], optical_depth(fragment.alpha));
    atomicAdd(&sums[pixel][1], fragment.alpha);
    atomicAdd(&sums[pixel][2], color.x);
    atomicAdd(&sums[pixel][3], color.y);
    atomicAdd(&sums[pixel][4], color.z);
}

fn keep(unit: Unit, pixel: u32, fragment: Fragment) {
    let key = min(depth_key(fragment.nearness), LAST_KEY - 1u);
    let slice = slice_of(begin, distance_of(fragment.nearness));
    if key < unit.low || key >= unit.high || slice < unit.first || slice >= unit.end {
        return;
    }
    let entry = atomicAdd(&total, 1u);
    if unit.is_mean == 1u {
        add_to_mean(pixel, fragment);
    } else if entry < ENTRIES {
        keys[entry] = key;
        colors[entry] = pack_color(fragment);
        places[entry] = (pixel << 16u) | atomicAdd(&counts[pixel], 1u);
    }
}

// What a reference leaves in an area; one column of SHARE.
fn collect(unit: Unit, area: vec4<u32>, reference: u32, share: u32) {
    let found = references[reference];
    // Once a unit: a segment is referred to from slices that follow each other.
    if reference >= bounds[unit.first + 1u] && (found & IS_NEAREST) == 0u {
        return;
    }
    let segment = segment_from(found & ~IS_NEAREST);
    let ribbon = ribbon_of(segment);
    let line = line_of(ribbon);
    let nearest = depth_key(max(ribbon.nearness.x, ribbon.nearness.y));
    let farthest = depth_key(min(ribbon.nearness.x, ribbon.nearness.y));
    // Rounding may move a fragment out of the range of its ends by a few keys.
    if !is_drawn(ribbon, line) || farthest + min(KEYS, LAST_KEY - farthest) < unit.low || nearest - min(KEYS, nearest) >= unit.high {
        return;
    }
    let span = span_of(ribbon, line);
    let first = select(vec2<i32>(area.xy), vec2<i32>(area.yx), span.steep);
    let last = select(vec2<i32>(area.zw), vec2<i32>(area.wz), span.steep) - 1;
    let first_column = max(span.first_column, first.x);
    let last_column = min(span.last_column, last.x);
    let middles = vec2(middle_of(span, first_column), middle_of(span, last_column));
    let is_beside = max(middles.x, middles.y) + span.half_height < f32(first.y) - 1.0
        || min(middles.x, middles.y) - span.half_height > f32(last.y) + 1.0;
    if first_column > last_column || is_beside {
        return;
    }
    let corner = area.xy / TILE * TILE;
    let paint = paint_of(segment);
    for (var column = first_column + i32(share); column <= last_column; column += i32(SHARE)) {
        let middle = middle_of(span, column);
        let last_row = min(i32(floor(middle + span.half_height)), last.y);
        for (var row = max(i32(ceil(middle - span.half_height)), first.y); row <= last_row; row++) {
            let pixel = vec2<u32>(select(vec2(column, row), vec2(row, column), span.steep));
            let own = (pixel.y - corner.y) * TILE + pixel.x - corner.x;
            if (atomicLoad(&closed[own / 32u]) & (1u << (own % 32u))) != 0u {
                continue;
            }
            let place = place_of(ribbon, line, pixel);
            if place < 0.0 || place >= 1.0 {
                continue;
            }
            let fragment = fragment_on(ribbon, line, paint, pixel, place);
            if fragment.alpha > 0u && fragment.nearness >= scene[own] {
                keep(unit, own, fragment);
            }
        }
    }
}

// A fragment on its way through the sort.
struct Sorted {
    key: u32,
    color: vec2<u32>,
    pixel: u32,
    place: u32,
}

// How many fragments of its pixel come before this one. The order is total: what is the same in it gives the same picture in
// any order.
fn rank_of(own: Sorted) -> u32 {
    var rank = 0u;
    let end = starts[own.pixel] + atomicLoad(&counts[own.pixel]);
    for (var i = starts[own.pixel]; i < end; i++) {
        let key = keys[i];
        if key < own.key {
            rank++;
        } else if key == own.key {
            let color = colors[i];
            let before = color.x < own.color.x || (color.x == own.color.x && color.y < own.color.y);
            rank += u32(before || (all(color == own.color) && i < own.place));
        }
    }
    return rank;
}

// Puts the colours of the unit in order, by pixel and depth. All lanes come here.
fn sort(count: u32, lane: u32) {
    // Sums within rows of pixels, then of the rows before.
    var before = 0u;
    if lane < PIXELS {
        for (var i = lane - lane % TILE; i < lane; i++) {
            before += atomicLoad(&counts[i]);
        }
        if lane % TILE == TILE - 1u {
            rows[lane / TILE] = before + atomicLoad(&counts[lane]);
        }
    }
    workgroupBarrier();
    if lane < PIXELS {
        for (var i = 0u; i < lane / TILE; i++) {
            before += rows[i];
        }
        starts[lane] = before;
    }
    workgroupBarrier();
    // By pixel first: each lane carries its fragments to their pixels, and then to their ranks.
    var own: array<Sorted, OWN>;
    for (var i = 0u; i < OWN; i++) {
        let entry = lane + i * LANES;
        if entry < count {
            let pixel = places[entry] >> 16u;
            own[i] = Sorted(keys[entry], colors[entry], pixel, starts[pixel] + (places[entry] & 0xffffu));
        }
    }
    workgroupBarrier();
    for (var i = 0u; i < OWN; i++) {
        if lane + i * LANES < count {
            keys[own[i].place] = own[i].key;
            colors[own[i].place] = own[i].color;
        }
    }
    workgroupBarrier();
    for (var i = 0u; i < OWN; i++) {
        if lane + i * LANES < count {
            own[i].place = starts[own[i].pixel] + rank_of(own[i]);
        }
    }
    workgroupBarrier();
    for (var i = 0u; i < OWN; i++) {
        if lane + i * LANES < count {
            colors[own[i].place] = own[i].color;
        }
    }
    workgroupBarrier();
}

fn over(front: Front, color: vec3<f32>, alpha: f32) -> Front {
    return Front(front.color + front.transmittance * alpha * color, front.transmittance * (1.0 - alpha));
}

// The sorted fragments of a pixel behind what lies before them.
fn blend_sorted(front: Front, pixel: u32) -> Front {
    var blended = front;
    let end = starts[pixel] + atomicLoad(&counts[pixel]);
    for (var i = starts[pixel]; i < end && blended.transmittance >= tiles.closed_below; i++) {
        let color = colors[i];
        blended = over(blended, packed_color(color), f32(packed_alpha(color)) / OPAQUE);
    }
    return blended;
}

fn blend_mean(front: Front, pixel: u32) -> Front {
    let weight = atomicLoad(&sums[pixel][1]);
    var blended = front;
    if weight > 0u {
        let color = vec3(atomicLoad(&sums[pixel][2]), atomicLoad(&sums[pixel][3]), atomicLoad(&sums[pixel][4]));
        let alpha = 1.0 - transmittance_of(atomicLoad(&sums[pixel][0]));
        blended = over(front, mean_color(color, weight, MEAN_UNIT), alpha);
    }
    for (var i = 0u; i < 5u; i++) {
        atomicStore(&sums[pixel][i], 0u);
    }
    return blended;
}

fn close(pixel: u32) {
    atomicOr(&closed[pixel / 32u], 1u << (pixel % 32u));
}

fn prepare(tile: WaitingTile, lane: u32, pixel: vec2<u32>, is_inside: bool) {
    if lane < SLICES {
        bounds[lane + 1u] = min(bins[lane * tile_count() + tile.tile] - tiles.first, tiles.capacity);
    }
    if lane < 2u {
        atomicStore(&closed[lane], 0u);
    }
    if lane < PIXELS {
        atomicStore(&counts[lane], 0u);
        for (var i = 0u; i < 5u; i++) {
            atomicStore(&sums[lane][i], 0u);
        }
    }
    if lane == 0u {
        bounds[0] = min(tile.first - tiles.first, tiles.capacity);
        begin = begin_of(tile.nearest);
        atomicStore(&total, 0u);
        atomicStore(&hairy_pixels, 0u);
    }
    workgroupBarrier();
    if is_inside {
        scene[lane] = scene_nearness(pixel);
    } else if lane < PIXELS {
        close(lane);
    }
    if lane == 0u {
        plan = unit_from(0u, FIRST_RATE);
    }
}

// Chooses what comes next; one lane comes here, all others wait.
fn go_on(unit: Unit, found: u32) {
    let is_closed = (atomicLoad(&closed[0]) & atomicLoad(&closed[1])) == 0xffffffffu;
    plan = next_unit(begin, unit, found);
    if is_closed {
        plan.first = SLICES;
    }
    atomicStore(&total, 0u);
}

// The pixels of a part of a tile: its first pixel, and the one after the last.
fn area_of(own: Job) -> vec4<u32> {
    let corner = vec2(own.tile.tile % tile_columns(), own.tile.tile / tile_columns()) * TILE;
    // Parts along an edge.
    let along = select(1u, 2u, own.parts == 4u);
    let first = corner + vec2(own.part % along, own.part / along) * (TILE / along);
    return vec4(first, min(first + TILE / along, view.size));
}

fn blend_part(own: Job, lane: u32) {
    let area = area_of(own);
    let corner = area.xy / TILE * TILE;
    let pixel = corner + vec2(lane % TILE, lane / TILE);
    let is_inside = lane < PIXELS && all(pixel >= area.xy) && all(pixel < area.zw);
    prepare(own.tile, lane, pixel, is_inside);
    var front = Front(vec3(0.0), 1.0);
    var fragments = 0u;
    loop {
        let unit = workgroupUniformLoad(&plan);
        if unit.first >= SLICES {
            break;
        }
        for (var i = bounds[unit.first] + lane / SHARE; i < bounds[unit.end]; i += LANES / SHARE) {
            collect(unit, area, i, lane % SHARE);
        }
        workgroupBarrier();
        let found = atomicLoad(&total);
        let is_blended = unit.is_mean == 1u || found <= ENTRIES;
        sort(select(0u, found, is_blended && unit.is_mean == 0u), lane);
        if lane < PIXELS {
            if unit.is_mean == 1u {
                front = blend_mean(front, lane);
            } else if is_blended {
                front = blend_sorted(front, lane);
            }
            atomicStore(&counts[lane], 0u);
            if front.transmittance < tiles.closed_below {
                close(lane);
            }
        }
        fragments += select(0u, found, is_blended);
        workgroupBarrier();
        if lane == 0u {
            go_on(unit, found);
        }
    }
    if is_inside {
        let color = vec4(front.color, 1.0 - front.transmittance);
        resolved[pixel.y * view.size.x + pixel.x] = vec2(pack2x16float(color.rg), pack2x16float(color.ba));
        atomicAdd(&hairy_pixels, u32(color.a > 0.0));
    }
    workgroupBarrier();
    if lane == 0u {
        let pixels = atomicLoad(&hairy_pixels);
        atomicAdd(&counters.pixels_with_hair, pixels);
        atomicAdd(&counters.fragments, fragments);
    }
}

// References that have no room: those behind all rounds, and those of a tile that has more than a round has left for it.
fn count_dropped(group: u32) {
    if group == 0u && tiles.first == 0u {
        counters.wanted = queue.references;
        atomicAdd(&counters.dropped, max(queue.references, tiles.covered) - tiles.covered);
    }
    if tiles.end != 0xffffffffu && job.part == 0u && job.parts > 0u {
        let end = min(bins[(SLICES - 1u) * tile_count() + job.tile.tile], tiles.covered) - tiles.first;
        atomicAdd(&counters.dropped, max(end, tiles.capacity) - tiles.capacity);
    }
}

@compute @workgroup_size(LANES)
fn tile_blend(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        let index = group.y * groups.x + group.x;
        job = job_of(index);
        count_dropped(index);
    }
    let own = workgroupUniformLoad(&job);
    if own.tile.tile != NO_TILE && own.parts > 0u {
        blend_part(own, lane);
    }
}
