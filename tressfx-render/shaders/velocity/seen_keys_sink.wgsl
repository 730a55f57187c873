// Fragments become the largest key of their pixel.

import package::fragment::{Fragment, seen_key};
import package::screen::view;

@group(0) @binding(6) var<storage, read_write> keys: array<atomic<u32>>;

struct Sink {
    unused: u32,
}

fn take(sink: ptr<function, Sink>, pixel: vec2<u32>, fragment: Fragment) {
    let index = pixel.y * view.size.x + pixel.x;
    let key = seen_key(fragment.nearness, fragment.alpha);
    // Keys only grow: most fragments need no turn at the atomic.
    if key > atomicLoad(&keys[index]) {
        atomicMax(&keys[index], key);
    }
}
