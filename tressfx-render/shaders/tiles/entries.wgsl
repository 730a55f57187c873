// The fragments of a unit, in the memory of a group: found in any order, then put into that of pixels, and painted in that of depth.

import package::constants::LANES;
import package::fragment::{Fragment, OPAQUE, pack_color};
@if(places)
import package::places::{Shares, pack_parts, unpack_parts};
import package::quarter::PIXELS;
import package::tiles::VERTEX_MASK;
import package::unit::{ENTRIES, ENTRIES_OF_A_LANE};

// A source: the first vertex of the segment that leaves the fragment, and above it the pixel.
const PIXEL_SHIFT: u32 = countOneBits(VERTEX_MASK);

// Fragments that were found in the unit, whether or not there was room for them.
var<workgroup> total: atomic<u32>;
// Depth and source, as they are found, then in the order of pixels. When all are painted, both words of their colours, in the order of pixels
// and depth.
var<workgroup> words: array<array<u32, ENTRIES>, 2>;
// Opacities at the places of the pixel, or what they are made from, in the same order.
@if(places)
var<workgroup> parts: array<vec2<u32>, ENTRIES>;
// Depths in that order.
@if(hair_output)
var<workgroup> sorted_keys: array<u32, ENTRIES>;
// 0 where no two fragments of a pixel have the same depth; else 1, or with `few_turns` how many have it at most.
var<workgroup> ties: atomic<u32>;
// Entries of a pixel that have no place yet.
var<workgroup> counts: array<atomic<u32>, PIXELS>;
// Entries of the pixels before, and of all.
var<workgroup> starts: array<u32, PIXELS + 1u>;
// Of what a pixel has, the largest share that was blended, as the bits of a number.
var<workgroup> blended_share: atomic<u32>;
// The nearest and the farthest key.
var<workgroup> ends: array<atomic<u32>, 2>;

// Forgets all entries.
fn empty(lane: u32) {
    if lane < PIXELS {
        atomicStore(&counts[lane], 0u);
    }
    if lane == 0u {
        atomicStore(&total, 0u);
        atomicStore(&ties, 0u);
        atomicStore(&blended_share, 0u);
        atomicStore(&ends[0], 0xffffffffu);
        atomicStore(&ends[1], 0u);
    }
}

// A fragment that was found.
fn add(pixel: u32, key: u32, start: u32) {
    let entry = atomicAdd(&total, 1u);
    if entry < ENTRIES {
        words[0][entry] = key;
        words[1][entry] = (pixel << PIXEL_SHIFT) | start;
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
    return Entry(words[0][place], words[1][place]);
}

fn put(entry: Entry) {
    let pixel = pixel_of(entry);
    let place = starts[pixel] + atomicSub(&counts[pixel], 1u) - 1u;
    words[0][place] = entry.key;
    words[1][place] = entry.source;
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
    let places = places_of(pixel_of(entry));
    // Those that are nearer, and those that are not farther: without a branch, since in each round some lane comes to its own entry.
    var nearer = places.x;
    var as_near = places.x;
    for (var i = places.x; i < places.y; i++) {
        let key = words[0][i];
        nearer += u32(key < entry.key);
        as_near += u32(key <= entry.key);
    }
    let same = as_near - nearer;
    var own = nearer;
    if same > 1u {
        for (var i = places.x; i < place; i++) {
            own += u32(words[0][i] == entry.key);
        }
    }
    return Rank(nearer, own, same);
}

// A fragment that is painted, until all are and its colour may take its place.
struct Painted {
    color: vec2<u32>,
    // `pack_rank`, or NO_RANK where a lane has no fragment.
    rank: u32,
}

const NO_RANK: u32 = 0xffffffffu;
// Bits of a place in a rank: none is above ENTRIES.
const PLACE_BITS: u32 = 10u;

fn pack_rank(rank: Rank) -> u32 {
    return rank.first | (rank.own << PLACE_BITS) | (rank.same << (2u * PLACE_BITS));
}

fn unpack_rank(packed: u32) -> Rank {
    return Rank(extractBits(packed, 0u, PLACE_BITS), extractBits(packed, PLACE_BITS, PLACE_BITS), extractBits(packed, 2u * PLACE_BITS, PLACE_BITS));
}

// What is not of the colour goes to its place at once.
fn paint(entry: Entry, place: u32, fragment: Fragment) -> Painted {
    let rank = rank_of(entry, place);
    if rank.same > 1u {
        @if(!few_turns) { atomicStore(&ties, 1u); }
        @if(few_turns) { atomicMax(&ties, rank.same); }
    }
    @if(places) { parts[rank.own] = pack_parts(fragment.stripe, f32(fragment.alpha) / OPAQUE); }
    @if(hair_output) { sorted_keys[rank.own] = entry.key; }
    return Painted(pack_color(fragment), pack_rank(rank));
}

// What a lane has painted of a unit, the last one first. (Not an array: it would stay in registers only where loops over it are unrolled.)
struct OwnPainted {
    first: Painted,
    second: Painted,
    third: Painted,
}

fn none_painted() -> OwnPainted {
    let none = Painted(vec2(0u), NO_RANK);
    return OwnPainted(none, none, none);
}

// Up to ENTRIES_OF_A_LANE are kept.
fn with_one_more(own: OwnPainted, next: Painted) -> OwnPainted {
    return OwnPainted(next, own.first, own.second);
}

// A place for nothing is none.
fn put_color(color: vec2<u32>, place: u32) {
    if place < ENTRIES {
        words[0][place] = color.x;
        words[1][place] = color.y;
    }
}

// Colours take the place of depths and sources, which all lanes have read by then.
fn put_colors(own: OwnPainted) {
    put_color(own.first.color, unpack_rank(own.first.rank).own);
    put_color(own.second.color, unpack_rank(own.second.rank).own);
    put_color(own.third.color, unpack_rank(own.third.rank).own);
}

fn is_less(a: vec2<u32>, b: vec2<u32>, if_same: bool) -> bool {
    return a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && if_same)));
}

// Whether what was painted at the first of two places of one depth comes first. What is the same gives the same picture in any order.
fn is_before(a: u32, b: u32) -> bool {
    @if(places) {
        if all(color_at(a) == color_at(b)) {
            return is_less(parts[a], parts[b], a < b);
        }
    }
    return is_less(color_at(a), color_at(b), a < b);
}

// The place of a fragment by depth and colour.
fn place_by_color(painted: Painted) -> u32 {
    let rank = unpack_rank(painted.rank);
    if rank.own >= ENTRIES {
        return rank.own;
    }
    var own = rank.first;
    for (var i = rank.first; i < rank.first + rank.same; i++) {
        own += u32(is_before(i, rank.own));
    }
    return own;
}

@if(places)
fn own_parts(painted: Painted) -> vec2<u32> {
    return parts[min(unpack_rank(painted.rank).own, ENTRIES - 1u)];
}

// Puts those of one depth into the order of their colours: that in which they were put is not that of every run. All lanes come here.
fn settle_ties(own: OwnPainted) {
    let places = vec3(place_by_color(own.first), place_by_color(own.second), place_by_color(own.third));
    @if(places)
    let first_parts = own_parts(own.first);
    @if(places)
    let second_parts = own_parts(own.second);
    @if(places)
    let third_parts = own_parts(own.third);
    workgroupBarrier();
    put_color(own.first.color, places.x);
    put_color(own.second.color, places.y);
    put_color(own.third.color, places.z);
    @if(places) {
        put_parts(first_parts, places.x);
        put_parts(second_parts, places.y);
        put_parts(third_parts, places.z);
    }
    workgroupBarrier();
}

@if(places)
fn put_parts(own: vec2<u32>, place: u32) {
    if place < ENTRIES {
        parts[place] = own;
    }
}

// The places of a pixel's entries: the first, and the one after the last.
fn places_of(pixel: u32) -> vec2<u32> {
    return vec2(starts[pixel], starts[pixel + 1u]);
}

// Of a pixel with these places, those before one were blended.
fn note_blended(places: vec2<u32>, end: u32) {
    if end > places.x {
        // Numbers that are not negative are in the order of their bits.
        atomicMax(&blended_share, bitcast<u32>(f32(end - places.x) / f32(places.y - places.x)));
    }
}

// The entries of the pixel that has the most.
@if(few_turns)
fn most_of_a_pixel() -> u32 {
    var most = 0u;
    for (var pixel = 0u; pixel < PIXELS; pixel++) {
        most = max(most, starts[pixel + 1u] - starts[pixel]);
    }
    return most;
}

// The colour at a place.
fn color_at(place: u32) -> vec2<u32> {
    return vec2(words[0][place], words[1][place]);
}

// The opacities of an entry, at the places of the pixel from four `first` on.
@if(places)
fn parts_at(place: u32, first: u32) -> Shares {
    return unpack_parts(parts[place], first);
}
