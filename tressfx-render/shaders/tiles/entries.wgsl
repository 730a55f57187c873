// The fragments of a unit, in the memory of a group: found in any order, then put into that of pixels, and painted in that of depth.

import package::fragment::{Fragment, pack_color};
import package::quarter::PIXELS;
import package::tiles::VERTEX_MASK;
import package::unit::ENTRIES;

const LANES: u32 = 192u;
// Entries that a lane puts into the order of pixels.
const ENTRIES_OF_A_LANE: u32 = ENTRIES / LANES;
// A source: the first vertex of the segment that leaves the fragment, and above it the pixel.
const PIXEL_SHIFT: u32 = countOneBits(VERTEX_MASK);

// Fragments that were found in the unit, whether or not there was room for them.
var<workgroup> total: atomic<u32>;
// Depth and source, as they are found, then in the order of pixels.
var<workgroup> keys: array<u32, ENTRIES>;
var<workgroup> sources: array<u32, ENTRIES>;
// While fragments are found, first vertices of segments that touch the quarter. Then both words of the colours, in the order of pixels
// and depth.
var<workgroup> scratch: array<u32, 2u * ENTRIES>;
// Opacities at the places of the pixel, 16 bits each, in the same order.
@if(places)
var<workgroup> parts: array<vec2<u32>, ENTRIES>;
// Depths in that order.
@if(hair_output)
var<workgroup> sorted_keys: array<u32, ENTRIES>;
// 1 where fragments of one pixel have the same depth.
var<workgroup> has_ties: atomic<u32>;
// Entries of a pixel that have no place yet.
var<workgroup> counts: array<atomic<u32>, PIXELS>;
// Entries of the pixels before, and of all.
var<workgroup> starts: array<u32, PIXELS + 1u>;
// The nearest and the farthest key.
var<workgroup> ends: array<atomic<u32>, 2>;

// Forgets all entries.
fn empty(lane: u32) {
    if lane < PIXELS {
        atomicStore(&counts[lane], 0u);
    }
    if lane == 0u {
        atomicStore(&total, 0u);
        atomicStore(&has_ties, 0u);
        atomicStore(&ends[0], 0xffffffffu);
        atomicStore(&ends[1], 0u);
    }
}

// A fragment that was found.
fn add(pixel: u32, key: u32, start: u32) {
    let entry = atomicAdd(&total, 1u);
    if entry < ENTRIES {
        keys[entry] = key;
        sources[entry] = (pixel << PIXEL_SHIFT) | start;
        atomicAdd(&counts[pixel], 1u);
    }
}

struct Entry {
    key: u32,
    source: u32,
}

// The first vertex of its segment.
fn start_of(entry: Entry) -> u32 {
    return entry.source & VERTEX_MASK;
}

fn pixel_of(entry: Entry) -> u32 {
    return entry.source >> PIXEL_SHIFT;
}

fn entry_at(place: u32) -> Entry {
    return Entry(keys[place], sources[place]);
}

fn put(entry: Entry) {
    let pixel = pixel_of(entry);
    let place = starts[pixel] + atomicSub(&counts[pixel], 1u) - 1u;
    keys[place] = entry.key;
    sources[place] = entry.source;
}

// Puts entries into the order of pixels. All lanes come here.
fn gather(count: u32, lane: u32) {
    if lane <= PIXELS {
        var sum = 0u;
        for (var i = 0u; i < lane; i++) {
            sum += atomicLoad(&counts[i]);
        }
        starts[lane] = sum;
    }
    // (Not an array of structs: of one that starts as zero HLSL is made that some compilers refuse.)
    var own_keys: array<u32, ENTRIES_OF_A_LANE>;
    var own_sources: array<u32, ENTRIES_OF_A_LANE>;
    for (var i = 0u; i < ENTRIES_OF_A_LANE; i++) {
        let entry = entry_at(lane + i * LANES);
        own_keys[i] = entry.key;
        own_sources[i] = entry.source;
    }
    workgroupBarrier();
    for (var i = 0u; i < ENTRIES_OF_A_LANE; i++) {
        if lane + i * LANES < count {
            put(Entry(own_keys[i], own_sources[i]));
        }
    }
    workgroupBarrier();
}

// Where an entry is by depth, and how many of its pixel have the same.
struct Rank {
    // The place of the first of them.
    first: u32,
    // Its own, in the order in which they were put.
    own: u32,
    same: u32,
}

// The rank of an entry at a place in the order of pixels.
fn rank_of(entry: Entry, place: u32) -> Rank {
    let pixel = pixel_of(entry);
    var rank = Rank(starts[pixel], 0u, 0u);
    for (var i = starts[pixel]; i < starts[pixel + 1u]; i++) {
        rank.first += u32(keys[i] < entry.key);
        if keys[i] == entry.key {
            rank.same += 1u;
            rank.own += u32(i < place);
        }
    }
    rank.own += rank.first;
    return rank;
}

fn paint(entry: Entry, place: u32, fragment: Fragment) {
    let rank = rank_of(entry, place);
    if rank.same > 1u {
        atomicStore(&has_ties, 1u);
    }
    let color = pack_color(fragment);
    scratch[rank.own] = color.x;
    scratch[ENTRIES + rank.own] = color.y;
    @if(places) { parts[rank.own] = vec2(pack2x16unorm(fragment.parts.xy), pack2x16unorm(fragment.parts.zw)); }
    @if(hair_output) { sorted_keys[rank.own] = entry.key; }
}

// A fragment that is painted.
struct Painted {
    color: vec2<u32>,
    @if(places)
    parts: vec2<u32>,
    place: u32,
}

fn painted_at(place: u32) -> Painted {
    @if(!places) { return Painted(color_at(place), place); }
    @if(places) { return Painted(color_at(place), parts[place], place); }
}

fn is_less(a: vec2<u32>, b: vec2<u32>, if_same: bool) -> bool {
    return a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && if_same)));
}

// Whether the first of two of one depth comes first. What is the same gives the same picture in any order.
fn is_before(a: Painted, b: Painted) -> bool {
    @if(places) {
        if all(a.color == b.color) {
            return is_less(a.parts, b.parts, a.place < b.place);
        }
    }
    return is_less(a.color, b.color, a.place < b.place);
}

// The entry at a place in the order of pixels as it is painted, with its place by depth and colour.
fn by_color(place: u32) -> Painted {
    let rank = rank_of(entry_at(place), place);
    var painted = painted_at(rank.own);
    var own = rank.first;
    for (var i = rank.first; i < rank.first + rank.same; i++) {
        own += u32(is_before(painted_at(i), painted));
    }
    painted.place = own;
    return painted;
}

// Puts those of one depth into the order of their colours: that in which they were put is not that of every run. All lanes come here.
fn settle_ties(count: u32, lane: u32) {
    var own_colors: array<vec2<u32>, ENTRIES_OF_A_LANE>;
    @if(places)
    var own_parts: array<vec2<u32>, ENTRIES_OF_A_LANE>;
    var own_places: array<u32, ENTRIES_OF_A_LANE>;
    for (var i = 0u; i < ENTRIES_OF_A_LANE; i++) {
        if lane + i * LANES < count {
            let painted = by_color(lane + i * LANES);
            own_colors[i] = painted.color;
            @if(places) { own_parts[i] = painted.parts; }
            own_places[i] = painted.place;
        }
    }
    workgroupBarrier();
    for (var i = 0u; i < ENTRIES_OF_A_LANE; i++) {
        if lane + i * LANES < count {
            scratch[own_places[i]] = own_colors[i].x;
            scratch[ENTRIES + own_places[i]] = own_colors[i].y;
            @if(places) { parts[own_places[i]] = own_parts[i]; }
        }
    }
    workgroupBarrier();
}

// The places of a pixel's entries: the first, and the one after the last.
fn places_of(pixel: u32) -> vec2<u32> {
    return vec2(starts[pixel], starts[pixel + 1u]);
}

// The colour at a place.
fn color_at(place: u32) -> vec2<u32> {
    return vec2(scratch[place], scratch[ENTRIES + place]);
}

// The opacities at a place.
@if(places)
fn parts_at(place: u32) -> vec4<f32> {
    return vec4(unpack2x16unorm(parts[place].x), unpack2x16unorm(parts[place].y));
}
