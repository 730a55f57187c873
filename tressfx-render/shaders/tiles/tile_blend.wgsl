// The pixels of a tile, from front to back, one group a quarter of a tile, or a part of it where few tiles have hair. It goes through the slices in units: as much of them as
// should fill the list of fragments. The fragments of a unit are sorted by pixel and depth, and blended; pixels that have become
// opaque take no more; the quarter ends when all are closed.
//
// A fragment belongs to the unit of its own depth, so that a segment that is referred to from several slices leaves each
// fragment once. A unit with too many fragments blends nothing and is tried again with fewer of its slices, or a part of the
// depths of its slice. Where fragments of one and the same depth are too many, they are blended as their mean.

import package::constants::LANES;
import package::cuts::{CUT_OF_PART, bit_of_part, note_end, pack_cuts, recall_cuts};
import package::entries::{
    Painted, add, blended_share, color_at, empty, ends, entry_at, gather, none_painted, note_blended, paint, pixel_of, places_of, put_colors,
    settle_ties, start_of, ties, total, with_one_more,
};
import package::fragment::{OPAQUE, depth_key, nearness_of, packed_alpha, packed_color};
import package::front::{Front, nothing_yet, over, passes};
import package::hidden::{FARTHEST, HairState, hidden_by};
import package::joined::{Joined, blends, is_last_to_close, join, none_closed, pixel_of_lane};
import package::line::{Line, fragment_alone, fragment_of_axis, is_drawn, line_of, place_of, span_of};
import package::mean::{add_to_mean, blend_mean, empty_mean};
import package::quarter::{PIXELS, QUARTER, touched};
import package::ribbon::Ribbon;
import package::screen::{distance_of, scene_nearness, tile_columns, tile_count, view};
import package::segments::{paint_of, ribbon_of};
import package::tile::{TILE, resolved_index};
import package::tiles::{CLASSES, FIRST_QUARTER, IS_NEAREST, PARTS, PARTS_OF_A_QUARTER, QUARTERS, REACHES_ON, SLICES, SharedTileInfo, TileInfo, VERTEX_MASK, ViewState, WaitingTiles, begin_of, groups_of_a_tile, is_cut, is_restless, tiles};
import package::unit::{ENTRIES, FIRST_RATE, LAST_KEY, Unit, begin, bounds, last_key, next_unit, unit_from};

@if(places)
import package::entries::parts_at;
@if(places)
import package::joined::first_four;
@if(few_turns)
import package::unit::references_before;
@if(few_turns)
import package::turns::{may_go_on, none_turned, note_chunk, note_unit};
@if(hair_output)
import package::entries::sorted_keys;
@if(hair_output)
import package::fragment::{FAINT, NOT_FAINT, seen_key};
@if(hair_output)
import package::mean::largest_alpha;

@group(0) @binding(4) var<storage, read_write> state: ViewState;
// The end of each slice of each tile, a slice after the other.
@group(0) @binding(6) var<storage, read> bins: array<u32>;
@group(0) @binding(7) var<storage, read> queue: WaitingTiles;
@group(0) @binding(8) var<storage, read> references: array<u32>;
// Premultiplied colour and alpha as four half floats, a pixel: those of a tile in its slot.
@if(!hair_output)
@group(0) @binding(9) var<storage, read_write> resolved: array<vec2<u32>>;
// Three words a pixel: the same, and the key of the fragment whose depth the pixel has.
@if(hair_output)
@group(0) @binding(9) var<storage, read_write> resolved: array<u32>;
@group(0) @binding(10) var<storage, read_write> infos: array<SharedTileInfo>;

const NO_TILE: u32 = 0xffffffffu;
// References that a lane looks at before the group draws those that touch its quarter. (With more memory for them a compiler gives lanes more registers,
// and fewer lanes run at once.)
const LOOKS: u32 = select(2u, 1u, LANES < 128u);
// Keys by which a fragment may be out of the range of its ends.
const KEYS: u32 = 16u;

// Parts of a quarter of a tile.
struct Job {
    tile: u32,
    quarter: u32,
    info: TileInfo,
    // A bit for each part of the quarter that is to be blended by the group in this round.
    parts: u32,
    // 1 for one group of each tile of the round.
    is_first: u32,
}

var<workgroup> job: Job;
var<workgroup> plan: Unit;
// First vertices of segments that touch the quarter.
var<workgroup> hits: array<u32, LANES * (LOOKS + 1u)>;
var<workgroup> hit_count: atomic<u32>;
// Nearness of the scene.
var<workgroup> scene: array<f32, PIXELS>;
// A bit a pixel that takes more.
var<workgroup> open: atomic<u32>;
// Distance behind which nothing is seen; below 0 where there is none.
var<workgroup> seen_to: f32;
var<workgroup> hairy_pixels: atomic<u32>;
var<workgroup> blended_fragments: atomic<u32>;

// The key of the nearest fragment that was blended into the pixel of the lane.
@if(hair_output)
var<private> seen: u32;

// The work of a group: the heaviest tiles come first.
fn job_of(group: u32) -> Job {
    // All at once: none waits for another.
    let sizes = queue.sizes;
    let groups = groups_of_a_tile(queue.size);
    var rest = group / groups;
    for (var i = CLASSES; i > 0u; i--) {
        let size = sizes[i - 1u];
        if rest < size {
            return job_in(queue.tiles[(i - 1u) * tile_count() + rest], group % groups, groups);
        }
        rest -= size;
    }
    return Job(NO_TILE, 0u, TileInfo(), 0u, 0u);
}

// What the group with this number of those of a tile is to blend: a quarter or a part of it.
fn job_in(tile: u32, number: u32, groups: u32) -> Job {
    let quarter = number * QUARTERS / groups;
    let parts = select(PARTS_OF_A_QUARTER, 1u << (number % PARTS), groups > QUARTERS);
    var info: TileInfo;
    info.nearest = bitcast<f32>(atomicLoad(&infos[tile].nearest));
    info.farthest = infos[tile].farthest;
    info.scene = infos[tile].scene;
    info.first = infos[tile].first;
    info.slot = infos[tile].slot;
    let waiting = (atomicLoad(&infos[tile].waiting) >> (PARTS * quarter)) & parts;
    let is_now = info.first >= tiles.first && info.first < tiles.end;
    return Job(tile, quarter, info, select(0u, waiting, is_now), u32(is_now && number == 0u));
}

// The part of a quarter in which a pixel is.
fn part_of_pixel(own: u32) -> u32 {
    return (own / (2u * QUARTER)) * 2u + (own / 2u) % 2u;
}

// Whether the pixel of the lane is the group's to blend.
fn is_own(own: Job, corner: vec2<u32>, lane: u32) -> bool {
    return lane < PIXELS && ((own.parts >> part_of_pixel(lane)) & 1u) == 1u && all(pixel_at(corner, lane) < view.size);
}

fn pixel_at(corner: vec2<u32>, own: u32) -> vec2<u32> {
    return corner + vec2(own % QUARTER, own / QUARTER);
}

fn key_of(nearness: f32) -> u32 {
    return min(depth_key(nearness), LAST_KEY - 1u);
}

// The pixels of a quarter that are the share of one of two or of four lanes, a bit each; all where a lane is alone. Of a row, a column and
// a slanted line all have about as many. (`power` is that of two.)
fn share_of(number: u32, power: u32) -> u32 {
    let fourth = 0x12481248u >> (QUARTER * (number & ((1u << power) - 1u)));
    return select(select(fourth, fourth | (fourth >> 8u), power == 1u), 0xffffu, power == 0u);
}

// The pixels of the quarter, a bit each, in which a segment may leave fragments in a unit.
fn pixels_in(unit: Unit, corner: vec2<u32>, ribbon: Ribbon, line: Line) -> u32 {
    let nearest = depth_key(max(ribbon.nearness.x, ribbon.nearness.y));
    let farthest = depth_key(min(ribbon.nearness.x, ribbon.nearness.y));
    // Rounding may move a fragment out of the range of its ends by a few keys.
    if !is_drawn(ribbon, line) || farthest + min(KEYS, LAST_KEY - farthest) < unit.low || nearest - min(KEYS, nearest) >= unit.high {
        return 0u;
    }
    return touched(span_of(ribbon, line), corner) & atomicLoad(&open);
}

// Where along a ribbon the pixel is, and the key of the fragment there: LAST_KEY where it leaves none in the unit.
struct Found {
    place: f32,
    key: u32,
}

fn found_at(unit: Unit, corner: vec2<u32>, ribbon: Ribbon, line: Line, own: u32) -> Found {
    let place = place_of(ribbon, line, pixel_at(corner, own));
    let nearness = mix(ribbon.nearness.x, ribbon.nearness.y, place);
    let key = key_of(nearness);
    let is_found = place >= 0.0 && nearness >= scene[own] && key >= unit.low && key < unit.high;
    return Found(place, select(LAST_KEY, key, is_found));
}

// Finds what a segment leaves in some pixels of the quarter. Keys that are found are between the nearest and the farthest of them.
fn find(unit: Unit, corner: vec2<u32>, start: u32, pixels: u32, ends_found: ptr<function, vec2<u32>>) {
    let ribbon = ribbon_of(start);
    let line = line_of(ribbon);
    for (var rest = pixels_in(unit, corner, ribbon, line) & pixels; rest != 0u; rest &= rest - 1u) {
        let own = firstTrailingBit(rest);
        let key = found_at(unit, corner, ribbon, line, own).key;
        if key != LAST_KEY {
            *ends_found = vec2(min((*ends_found).x, key), max((*ends_found).y, key));
            add(own, key, start);
        }
    }
}

// The same where fragments are blended as their mean. (A loop of its own: this nearly never runs, and would take registers from the other.)
fn find_mean(unit: Unit, corner: vec2<u32>, start: u32, pixels: u32) {
    let ribbon = ribbon_of(start);
    let line = line_of(ribbon);
    for (var rest = pixels_in(unit, corner, ribbon, line) & pixels; rest != 0u; rest &= rest - 1u) {
        let own = firstTrailingBit(rest);
        let found = found_at(unit, corner, ribbon, line, own);
        if found.key != LAST_KEY {
            add_to_mean(own, fragment_of_axis(ribbon, line, paint_of(start), pixel_at(corner, own), found.place));
        }
    }
}

// Whether a reference is to be drawn: its segment touches the quarter and a slice of the unit, and comes once a unit, though it may be
// referred to from several slices.
fn is_hit(unit: Unit, quarter: u32, place: u32, reference: u32) -> bool {
    var flag = IS_NEAREST;
    if place < bounds[unit.first + 1u] {
        flag = select(FIRST_QUARTER << quarter, REACHES_ON, place < bounds[unit.first]);
    }
    let wanted = flag | (FIRST_QUARTER << quarter);
    return (reference & wanted) == wanted;
}

// Draws the segments of the unit. All lanes come here.
fn collect(unit: Unit, own: Job, corner: vec2<u32>, lane: u32) {
    var ends_found = vec2(LAST_KEY, 0u);
    let end = bounds[unit.end];
    for (var chunk = bounds[max(unit.first, 1u) - 1u]; chunk < end; chunk += LANES * LOOKS) {
        var own_hits = 0u;
        for (var i = 0u; i < LOOKS && chunk + i * LANES < end; i++) {
            let place = chunk + i * LANES + lane;
            if place < end && is_hit(unit, own.quarter, place, references[place]) {
                own_hits |= 1u << i;
            }
        }
        var hit = atomicAdd(&hit_count, countOneBits(own_hits));
        for (; own_hits != 0u; own_hits &= own_hits - 1u) {
            hits[hit] = references[chunk + firstTrailingBit(own_hits) * LANES + lane] & VERTEX_MASK;
            hit++;
        }
        workgroupBarrier();
        let count = atomicLoad(&hit_count);
        // Those that do not fill all lanes wait for more, in front, until there are no more.
        let waiting = select(count % LANES, 0u, chunk + LANES * LOOKS >= end);
        // A lane goes from pixel to pixel: where there are more lanes than segments, two or four share one.
        let power = select(select(0u, 1u, 2u * count <= LANES), 2u, 4u * count <= LANES);
        for (var i = lane + (waiting << power); i < count << power; i += LANES) {
            if unit.is_mean == 1u {
                find_mean(unit, corner, hits[i >> power], share_of(i, power));
            } else {
                find(unit, corner, hits[i >> power], share_of(i, power), &ends_found);
            }
        }
        workgroupBarrier();
        if lane == 0u {
            atomicStore(&hit_count, waiting);
            @if(few_turns) { note_chunk(LOOKS + 1u, (count - waiting + LANES - 1u) / LANES); }
        }
        workgroupBarrier();
        @if(few_turns) {
            if !may_go_on() {
                break;
            }
        }
    }
    if atomicLoad(&total) > ENTRIES {
        atomicMin(&ends[0], ends_found.x);
        atomicMax(&ends[1], ends_found.y);
    }
}

// The colour of the fragment that was found at a place.
fn painted_at(place: u32, corner: vec2<u32>) -> Painted {
    let entry = entry_at(place);
    let start = start_of(entry);
    let ribbon = ribbon_of(start);
    let line = line_of(ribbon);
    let pixel = pixel_at(corner, pixel_of(entry));
    return paint(entry, place, fragment_alone(ribbon, line, paint_of(start), pixel, place_of(ribbon, line, pixel)));
}

// The colours of the fragments that were found: as many lanes have work as there are fragments. All lanes come here.
fn paint_all(count: u32, corner: vec2<u32>, lane: u32) {
    var own = none_painted();
    for (var place = lane; place < count; place += LANES) {
        own = with_one_more(own, painted_at(place, corner));
    }
    workgroupBarrier();
    put_colors(own);
    if workgroupUniformLoad(&ties) != 0u {
        settle_ties(own);
    }
}

// The sorted fragments of the pixel of a lane behind what lies before them.
fn blend_sorted(front: Front, lane: u32) -> Front {
    var blended = front;
    let places = places_of(pixel_of_lane(lane));
    var i = places.x;
    for (; i < places.y && passes(blended) >= tiles.closed_below; i++) {
        let color = color_at(i);
        let alpha = packed_alpha(color);
        @if(!places) { blended = over(blended, packed_color(color), f32(alpha) / OPAQUE, u32(alpha > 0u)); }
        @if(places) { blended = over(blended, packed_color(color), parts_at(i, first_four(lane)), u32(alpha > 0u)); }
        @if(hair_output) {
            // What comes later is farther: only the first one counts, and the first one that is not faint.
            if alpha > 0u && (seen == 0u || (seen < NOT_FAINT && alpha >= FAINT)) {
                seen = seen_key(nearness_of(sorted_keys[i]), alpha);
            }
        }
    }
    note_blended(places, i);
    return blended;
}

// All fragments of such a unit have one key.
@if(hair_output)
fn see_mean(unit: Unit, pixel: u32) {
    let alpha = largest_alpha(pixel);
    if alpha > 0u {
        seen = max(seen, seen_key(nearness_of(unit.low), alpha));
    }
}

// Where the quarter begins, and what lies before it.
fn prepare(own: Job, corner: vec2<u32>, lane: u32) {
    if is_own(own, corner, lane) {
        scene[lane] = scene_nearness(pixel_at(corner, lane));
    }
    for (var i = lane; i < SLICES; i += LANES) {
        bounds[i + 1u] = min(bins[i * tile_count() + own.tile] - tiles.first, tiles.capacity);
    }
    empty(lane);
    if lane == 0u {
        bounds[0] = min(own.info.first - tiles.first, tiles.capacity);
        begin = begin_of(own.info.nearest);
        last_key = LAST_KEY;
        if is_cut(own.info) {
            last_key = max(depth_key(own.info.farthest), KEYS) - KEYS;
        }
        seen_to = -1.0;
        recall_cuts(atomicLoad(&state.tiles[own.tile].cuts[own.quarter]), own.parts);
        @if(few_turns) { none_turned(); }
        atomicStore(&open, 0u);
        atomicStore(&hit_count, 0u);
        atomicStore(&hairy_pixels, 0u);
        atomicStore(&blended_fragments, 0u);
    }
    workgroupBarrier();
    if lane < PIXELS {
        empty_mean(lane);
        none_closed(lane);
    }
    if is_own(own, corner, lane) {
        atomicOr(&open, 1u << lane);
    }
    if lane == 0u {
        plan = unit_from(0u, 0u, 0.0, FIRST_RATE * f32(countOneBits(own.parts)) / f32(PARTS));
    }
}

// Blends all units. Returns what the places of the lane have.
fn blend_units(own: Job, corner: vec2<u32>, lane: u32) -> Front {
    var front = nothing_yet();
    loop {
        let unit = workgroupUniformLoad(&plan);
        if unit.first >= SLICES {
            break;
        }
        collect(unit, own, corner, lane);
        @if(few_turns) {
            if !may_go_on() {
                break;
            }
        }
        let found = atomicLoad(&total);
        let is_blended = unit.is_mean == 1u || found <= ENTRIES;
        let count = select(0u, found, is_blended && unit.is_mean == 0u);
        gather(count, lane);
        paint_all(count, corner, lane);
        if lane == LANES - 1u {
            // While others blend. The ends are known where there are too many fragments.
            @if(few_turns) { note_unit(count > 0u); }
            plan = next_unit(unit, found, vec2(atomicLoad(&ends[0]), atomicLoad(&ends[1])));
        }
        if blends(lane) && is_blended && passes(front) >= tiles.closed_below {
            let pixel = pixel_of_lane(lane);
            if unit.is_mean == 1u {
                front = blend_mean(front, pixel);
                @if(hair_output) { see_mean(unit, pixel); }
            } else {
                front = blend_sorted(front, lane);
            }
            if passes(front) < tiles.closed_below && is_last_to_close(pixel) {
                atomicAnd(&open, ~(1u << pixel));
            }
        }
        workgroupBarrier();
        if unit.is_mean == 1u && lane < PIXELS {
            empty_mean(lane);
        }
        if lane == 0u && atomicLoad(&open) == 0u {
            plan.first = SLICES;
            plan.end = unit.end;
            plan.to_reference = unit.to_reference;
            note_end(unit.from_reference, unit.to_reference, bitcast<f32>(atomicLoad(&blended_share)));
            seen_to = distance_of(max(nearness_of(unit.high), 1.0 / FARTHEST));
        }
        empty(lane);
    }
    return front;
}

// What the pixel of the lane has: of the first lane of each.
fn joined_of(front: Front, lane: u32) -> Joined {
    @if(hair_output) { return join(front, seen, lane); }
    @if(!hair_output) { return join(front, 0u, lane); }
}

fn blend_parts(own: Job, lane: u32) {
    let tile = vec2(own.tile % tile_columns(), own.tile / tile_columns());
    let corner = TILE * tile + QUARTER * vec2(own.quarter % 2u, own.quarter / 2u);
    prepare(own, corner, lane);
    let blended = joined_of(blend_units(own, corner, lane), lane);
    let is_done = workgroupUniformLoad(&seen_to) >= 0.0 || !is_cut(own.info);
    let pixel = pixel_at(corner, lane);
    if is_done && is_own(own, corner, lane) {
        let color = vec4(blended.color, 1.0 - blended.passes);
        let place = resolved_index(own.info.slot - 1u, pixel);
        @if(!hair_output) {
            resolved[place] = vec2(pack2x16float(color.rg), pack2x16float(color.ba));
        }
        @if(hair_output) {
            resolved[3u * place] = pack2x16float(color.rg);
            resolved[3u * place + 1u] = pack2x16float(color.ba);
            resolved[3u * place + 2u] = blended.seen;
        }
        atomicAdd(&hairy_pixels, u32(color.a > 0.0));
        atomicAdd(&blended_fragments, blended.fragments);
    }
    if is_done && lane == LANES - 1u {
        // While others write their pixels.
        keep(own);
    }
    workgroupBarrier();
    if is_done && lane == 0u {
        atomicAdd(&state.counters.pixels_with_hair, atomicLoad(&hairy_pixels));
        atomicAdd(&state.counters.fragments, atomicLoad(&blended_fragments));
        @if(few_turns) {
            if plan.first < SLICES {
                atomicAdd(&state.counters.dropped, u32(references_before(SLICES) - plan.from_reference) + 1u);
            }
        }
        atomicAnd(&infos[own.tile].waiting, ~(own.parts << (PARTS * own.quarter)));
    }
}

// What the next frame is told.
fn keep(own: Job) {
    if tiles.skips_hidden == 1u {
        let hair = HairState(is_restless(atomicLoad(&state.reopened)), queue.references > tiles.crowd);
        atomicMax(&state.tiles[own.tile].hidden, hidden_by(own.info, plan, seen_to, hair));
    }
    var cuts = pack_cuts();
    // Where a group ends early depends on its units: it leaves none, so that the next frame ends where this one does.
    @if(few_turns) { cuts = select(cuts, 0u, plan.first < SLICES); }
    let word = &state.tiles[own.tile].cuts[own.quarter];
    if own.parts == PARTS_OF_A_QUARTER {
        atomicStore(word, cuts);
    } else {
        // No other group has these bits.
        let bit = bit_of_part(own.parts);
        atomicAnd(word, ~(CUT_OF_PART << bit));
        atomicOr(word, (cuts & CUT_OF_PART) << bit);
    }
}

// References that have no room: those behind all rounds, and those of a tile that has more than a round has left for it.
fn count_dropped(group: u32) {
    if group == 0u && tiles.first == 0u {
        state.counters.wanted = max(state.counters.wanted, queue.references);
        atomicAdd(&state.counters.dropped, max(queue.references, tiles.covered) - tiles.covered);
    }
    if tiles.end != 0xffffffffu && job.is_first == 1u {
        let end = min(bins[(SLICES - 1u) * tile_count() + job.tile], tiles.covered) - tiles.first;
        atomicAdd(&state.counters.dropped, max(end, tiles.capacity) - tiles.capacity);
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
    if own.parts != 0u {
        blend_parts(own, lane);
    }
}
