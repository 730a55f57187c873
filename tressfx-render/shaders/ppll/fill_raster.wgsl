// What `fill` does, with the raster units: every fragment asks the pool for a node itself.

import package::fragment::Fragment;
import package::quad::{Corner, corner_of, fragment_of, pixel_of};
import package::screen::view;
import package::sink::{counters, link, pool};

@if(bounded)
import package::rest::add_to_rest;
@if(bounded)
import package::sink::{count_behind, is_kept, rest_weight};

@vertex
fn segment_corner(@builtin(vertex_index) vertex: u32) -> Corner {
    return corner_of(vertex);
}

// The number of a new node. The counter ends at the limit.
fn request() -> u32 {
    // There are always fewer fragments at work than there are numbers beyond the limit: the counter never wraps.
    if atomicLoad(&counters.fragments) >= pool.limit {
        return pool.limit;
    }
    return atomicAdd(&counters.fragments, 1u);
}

@if(!bounded)
fn append(index: u32, fragment: Fragment) {
    let node = request();
    // One that finds no room in the pool leaves the list as it is.
    if node < pool.capacity {
        link(index, node, fragment);
    }
}

@if(bounded)
fn append(index: u32, fragment: Fragment) {
    if is_kept(index, fragment) {
        let node = request();
        if node < pool.capacity {
            link(index, node, fragment);
            return;
        }
    } else {
        count_behind(1u);
    }
    add_to_rest(index, fragment, rest_weight(index, fragment));
}

@fragment
fn fill_raster(corner: Corner) -> @location(0) vec4<f32> {
    let fragment = fragment_of(corner);
    if fragment.alpha > 0u {
        let pixel = pixel_of(corner);
        append(pixel.y * view.size.x + pixel.x, fragment);
    }
    // The picture itself is drawn by the composite.
    discard;
    return vec4(0.0);
}
