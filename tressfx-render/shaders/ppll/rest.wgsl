// What the fragments of a pixel leave that have no node: the sums that a tail is made of. The head of the list of those that have one is beside
// them: a kernel can have eight buffers, and no more.

import package::fragment::{Fragment, pack_color, packed_color};
@if(hair_output)
import package::fragment::seen_key;
import package::sums::{optical_depth, weighted};

// Words of a pixel: sums of optical depths, of weights, and of red, green and blue, weighted.
@if(!hair_output)
const WORDS: u32 = 6u;
@if(hair_output)
const WORDS: u32 = 7u;
// Behind the sums, the number of the first node.
const HEAD: u32 = 5u;
// The key of the nearest fragment.
@if(hair_output)
const KEY: u32 = 6u;
// Of colours: there is room for 32 thousand white fragments.
const UNIT: f32 = 65536.0;

@group(0) @binding(11) var<storage, read_write> rest: array<atomic<u32>>;

// A sum that overflows sets its highest bit, and every later overflow does so again: in the end the bit is set if there was
// any, in whatever order threads came.
fn add(place: u32, value: u32) {
    if atomicAdd(&rest[place], value) > 0xffffffffu - value {
        atomicOr(&rest[place], 0x80000000u);
    }
}

// The colour is that of a node, so that a tail has the same sums, whichever way its fragments came to it.
fn add_to_rest(index: u32, fragment: Fragment, weight: u32) {
    let color = weighted(packed_color(pack_color(fragment)), weight, UNIT);
    add(WORDS * index, optical_depth(fragment.alpha));
    add(WORDS * index + 1u, weight);
    add(WORDS * index + 2u, color.r);
    add(WORDS * index + 3u, color.g);
    add(WORDS * index + 4u, color.b);
    @if(hair_output) { atomicMax(&rest[WORDS * index + KEY], seen_key(fragment.nearness, fragment.alpha)); }
}
