// Fragments become the keys of layers, and add to the optical depth of their pixel.

import package::constants::K;
import package::counters::Counters;
import package::fragment::{Fragment, OPAQUE};
import package::layers::layer_key;
import package::screen::view;
import package::sums::optical_depth;

// K a pixel.
@group(0) @binding(6) var<storage, read_write> layers: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read_write> opticals: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> counters: Counters;

struct Sink {
    count: u32,
}

fn take(sink: ptr<function, Sink>, pixel: vec2<u32>, fragment: Fragment) {
    (*sink).count++;
    let index = pixel.y * view.size.x + pixel.x;
    let optical = optical_depth(fragment.alpha);
    let old = atomicAdd(&opticals[index], optical);
    // One whose sum overflows sets the highest bit. Every later overflow does so again: in the end the bit is set if there
    // was any, in whatever order threads came.
    if old > 0xffffffffu - optical {
        atomicOr(&opticals[index], 0x80000000u);
    }
    insert(index * K, layer_key(fragment), f32(fragment.alpha) == OPAQUE);
}

// Each layer keeps the nearer of two and hands the other on, so that the K nearest are left, in order, however threads
// interleave. What hides all that is behind it fills all layers from its own on.
fn insert(first: u32, key: u32, hides: bool) {
    // Keys only grow: where K are as near already, nothing would change.
    if key <= atomicLoad(&layers[first + K - 1u]) {
        return;
    }
    var passed = key;
    for (var i = 0u; i < K && passed != 0u; i++) {
        let held = atomicMax(&layers[first + i], passed);
        passed = select(min(held, passed), key, hides);
    }
}

// As in the sum of a pixel: what has overflowed once stays full.
fn count_fragments(count: u32) {
    let old = atomicAdd(&counters.fragments, count);
    if old > 0xffffffffu - count {
        atomicOr(&counters.fragments, 0x80000000u);
    }
}
