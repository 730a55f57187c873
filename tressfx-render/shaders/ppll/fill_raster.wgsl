// What `fill` does, with the raster units: every fragment asks the pool for a node itself.

import package::counters::Counters;
import package::fragment::Fragment;
import package::node::pack_node;
import package::quad::{Corner, corner_of, fragment_of, pixel_of};
import package::sink::{heads, nodes, pool};
import package::screen::view;

@group(0) @binding(9) var<storage, read_write> counters: Counters;

@vertex
fn segment_corner(@builtin(vertex_index) vertex: u32) -> Corner {
    return corner_of(vertex);
}

fn append(pixel: vec2<u32>, fragment: Fragment) {
    // There are always fewer fragments at work than there are numbers beyond the limit: the counter never wraps.
    if atomicLoad(&counters.fragments) >= pool.limit {
        return;
    }
    let node = atomicAdd(&counters.fragments, 1u);
    // One that finds no room in the pool leaves the list as it is.
    if node < pool.capacity {
        let next = atomicExchange(&heads[pixel.y * view.size.x + pixel.x], node + 1u);
        nodes[node] = pack_node(fragment, next);
    }
}

@fragment
fn fill_raster(corner: Corner) -> @location(0) vec4<f32> {
    let fragment = fragment_of(corner);
    if fragment.alpha > 0u {
        append(pixel_of(corner), fragment);
    }
    // The picture itself is drawn by the composite.
    discard;
    return vec4(0.0);
}
