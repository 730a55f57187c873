// Lists of fragments, one a pixel. A node is a key, red and green, blue and alpha, and the number of the next; with places, what the fragment
// covers comes last.

import package::fragment::{Fragment, depth_key, pack_color};
@if(places)
import package::places::pack_stripe;

@if(!places)
alias Node = vec4<u32>;
@if(places)
struct Node {
    key: u32,
    red_green: u32,
    blue_alpha: u32,
    next: u32,
    stripe: u32,
}

// A node without the number of the next.
@if(!places)
alias Content = vec3<u32>;
@if(places)
alias Content = vec4<u32>;

// Nodes are numbered from 1, so that a cleared head is an empty list.
const NOTHING: u32 = 0u;

struct PoolUniform {
    // Fragments that there is room for.
    capacity: u32,
    // Where counting ends: at least the capacity, at most 2^31 - 1.
    limit: u32,
    // Requests up to this one are added without a look at the limit: all groups of the frame together ask for less than the
    // limit then, so that the counter stays below 2 * limit whatever happens, and never wraps.
    small_request: u32,
    // Where not all fragments have a node: how many of a pixel have, and how many were to have one.
    kept: u32,
    asked: u32,
    // 1 where the colours of a tail are weighted by what is seen of them.
    weighs: u32,
    // How many of the nearest are put in order.
    sorted: u32,
    // Nodes of the first of two buffers.
    first_nodes: u32,
    // The colour of a tail that is not shaded.
    unlit: vec4<f32>,
}

fn pack_node(fragment: Fragment, next: u32) -> Node {
    let key = depth_key(fragment.nearness);
    let color = pack_color(fragment);
    @if(!places) { return vec4(key, color, next); }
    @if(places) { return Node(key, color.x, color.y, next, pack_stripe(fragment.stripe)); }
}

fn next_of(node: Node) -> u32 {
    @if(!places) { return node.w; }
    @if(places) { return node.next; }
}

fn content_of(node: Node) -> Content {
    @if(!places) { return node.xyz; }
    @if(places) { return vec4(node.key, node.red_green, node.blue_alpha, node.stripe); }
}
