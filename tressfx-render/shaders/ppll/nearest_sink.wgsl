// Fragments become the keys of the nearest ones of their pixel.

import package::fragment::Fragment;
import package::kept::kept_key;
import package::node::PoolUniform;
import package::screen::view;

@group(0) @binding(6) var<uniform> pool: PoolUniform;
// `pool.kept` a pixel, the largest first.
@group(0) @binding(7) var<storage, read_write> nearest_keys: array<atomic<u32>>;

struct Sink {
    unused: u32,
}

// Each place keeps the nearer of two keys and hands the other on, so that the nearest are left, in order, however threads
// interleave.
fn take(sink: ptr<function, Sink>, pixel: vec2<u32>, fragment: Fragment) {
    let first = (pixel.y * view.size.x + pixel.x) * pool.kept;
    let last = first + pool.kept - 1u;
    var passed = kept_key(fragment.nearness);
    // Keys only grow: where all are as near already, nothing would change.
    if passed <= atomicLoad(&nearest_keys[last]) {
        return;
    }
    for (var i = first; i <= last && passed != 0u; i++) {
        passed = min(passed, atomicMax(&nearest_keys[i], passed));
    }
}
