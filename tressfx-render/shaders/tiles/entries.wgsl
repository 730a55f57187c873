// The fragments of a unit, in the memory of a group: found in any order, then sorted by pixel and depth.

import package::fragment::{Fragment, pack_color};
import package::quarter::PIXELS;
import package::unit::ENTRIES;

const LANES: u32 = 128u;
// Bits of a place: an entry's number among those of its pixel, the pixel, and the entry that is there once entries are in the
// order of pixels.
const PIXEL_SHIFT: u32 = 10u;
const ENTRY_SHIFT: u32 = 16u;

// Fragments that were found in the unit, whether or not there was room for them.
var<workgroup> total: atomic<u32>;
// Depth; once sorted, the entry that is at this place.
var<workgroup> keys: array<u32, ENTRIES>;
var<workgroup> colors: array<vec2<u32>, ENTRIES>;
// Opacities at the places of the pixel, 16 bits each.
@if(places)
var<workgroup> parts: array<vec2<u32>, ENTRIES>;
var<workgroup> places: array<atomic<u32>, ENTRIES>;
// The keys in the order of pixels.
var<workgroup> keys_of_pixels: array<u32, ENTRIES>;
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
        atomicStore(&ends[0], 0xffffffffu);
        atomicStore(&ends[1], 0u);
    }
}

fn add(entry: u32, pixel: u32, key: u32, fragment: Fragment) {
    if entry < ENTRIES {
        keys[entry] = key;
        colors[entry] = pack_color(fragment);
        @if(places) {
            parts[entry] = vec2(pack2x16unorm(fragment.parts.xy), pack2x16unorm(fragment.parts.zw));
        }
        atomicStore(&places[entry], (pixel << PIXEL_SHIFT) | atomicAdd(&counts[pixel], 1u));
    }
}

// Whether the first of two entries of one depth comes first. The order is total: what is the same in it gives the same picture in
// any order.
fn is_before(a: u32, b: u32) -> bool {
    let first = colors[a];
    let second = colors[b];
    @if(places) {
        if all(first == second) {
            return is_less(parts[a], parts[b], a < b);
        }
    }
    return is_less(first, second, a < b);
}

fn is_less(a: vec2<u32>, b: vec2<u32>, if_same: bool) -> bool {
    return a.x < b.x || (a.x == b.x && (a.y < b.y || (a.y == b.y && if_same)));
}

// How many of its pixel come before the entry at a place in the order of pixels.
fn rank_of(entry: u32, place: u32, first: u32, end: u32) -> u32 {
    let key = keys_of_pixels[place];
    var rank = 0u;
    for (var i = first; i < end; i++) {
        let other = keys_of_pixels[i];
        rank += u32(other < key);
        if other == key && i != place {
            rank += u32(is_before(atomicLoad(&places[i]) >> ENTRY_SHIFT, entry));
        }
    }
    return rank;
}

// Puts the entries in order: behind it, `keys` holds entries. All lanes come here.
fn sort(count: u32, lane: u32) {
    if lane <= PIXELS {
        var sum = 0u;
        for (var i = 0u; i < lane; i++) {
            sum += atomicLoad(&counts[i]);
        }
        starts[lane] = sum;
    }
    workgroupBarrier();
    for (var entry = lane; entry < count; entry += LANES) {
        let bits = atomicLoad(&places[entry]);
        let place = starts[(bits >> PIXEL_SHIFT) % PIXELS] + extractBits(bits, 0u, PIXEL_SHIFT);
        keys_of_pixels[place] = keys[entry];
        atomicOr(&places[place], entry << ENTRY_SHIFT);
    }
    workgroupBarrier();
    // Lanes beside each other compare with the same keys.
    for (var place = lane; place < count; place += LANES) {
        let entry = atomicLoad(&places[place]) >> ENTRY_SHIFT;
        let pixel = (atomicLoad(&places[entry]) >> PIXEL_SHIFT) % PIXELS;
        let first = starts[pixel];
        keys[first + rank_of(entry, place, first, starts[pixel + 1u])] = entry;
    }
    workgroupBarrier();
}

// The places of a pixel's entries: the first, and the one after the last.
fn places_of(pixel: u32) -> vec2<u32> {
    return vec2(starts[pixel], starts[pixel + 1u]);
}

// The colour at a place.
fn color_at(place: u32) -> vec2<u32> {
    return colors[keys[place]];
}

// The opacities at a place.
@if(places)
fn parts_at(place: u32) -> vec4<f32> {
    let packed = parts[keys[place]];
    return vec4(unpack2x16unorm(packed.x), unpack2x16unorm(packed.y));
}

// The depth of the entry at a place of a pixel. Its key is where it was before the entries of the pixel were put in order.
@if(hair_output)
fn key_at_place(pixel: u32, place: u32) -> u32 {
    var i = starts[pixel];
    while i + 1u < starts[pixel + 1u] && atomicLoad(&places[i]) >> ENTRY_SHIFT != keys[place] {
        i++;
    }
    return keys_of_pixels[i];
}
