// Fragments go to the heads of the lists of their pixels.

import package::fragment::Fragment;
import package::node::{PoolUniform, pack_node};
import package::screen::view;

@group(0) @binding(6) var<uniform> pool: PoolUniform;
@group(0) @binding(7) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> nodes: array<vec4<u32>>;

// A segment is walked twice: to count, with no room, and to store. What is counted goes into the nodes from `first` on, and
// never into more than were asked for, even if a compiler rounds the two walks differently. A node in two lists would close
// one of them to a ring.
struct Sink {
    first: u32,
    room: u32,
    count: u32,
}

fn take(sink: ptr<function, Sink>, pixel: vec2<u32>, fragment: Fragment) {
    let node = (*sink).first + (*sink).count;
    // One that finds no room in the pool leaves the list as it is.
    if (*sink).count < (*sink).room && node < pool.capacity {
        let next = atomicExchange(&heads[pixel.y * view.size.x + pixel.x], node + 1u);
        nodes[node] = pack_node(fragment, next);
    }
    (*sink).count++;
}
