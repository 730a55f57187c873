// Fragments go to the heads of the lists of their pixels; where lists are bounded, the nearest do, and the others to the rest.

import package::counters::Counters;
import package::fragment::Fragment;
import package::node::{Node, PoolUniform, pack_node};
import package::screen::view;

@if(bounded)
import package::kept::{is_nearest, kept_key, kept_nearness};
@if(bounded)
import package::rest::{HEAD, WORDS, add_to_rest, rest};
@if(bounded)
import package::weight::{Nearest, weight_of};

@group(0) @binding(6) var<uniform> pool: PoolUniform;
@if(!bounded)
@group(0) @binding(7) var<storage, read_write> heads: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> nodes: array<Node>;
// Where one buffer cannot hold all.
@if(more_nodes)
@group(0) @binding(14) var<storage, read_write> more_nodes: array<Node>;
@group(0) @binding(9) var<storage, read_write> counters: Counters;
// The keys of the nearest fragments of each pixel, `pool.kept` of them, the largest first.
@if(bounded)
@group(0) @binding(10) var<storage, read> nearest_keys: array<u32>;

// A segment is walked twice: to count, with no room, and to store. What is counted goes into the nodes from `first` on, and
// never into more than were asked for, even if a compiler rounds the two walks differently. A node in two lists would close
// one of them to a ring.
struct Sink {
    first: u32,
    room: u32,
    count: u32,
    // Fragments that are not to have a node.
    behind: u32,
    // 1 in the walk that stores.
    stores: u32,
}

// Whether a fragment is to have a node.
fn is_kept(index: u32, fragment: Fragment) -> bool {
    @if(bounded) {
        let last = index * pool.kept + pool.kept - 1u;
        return pool.kept > 0u && is_nearest(kept_key(fragment.nearness), nearest_keys[last]);
    }
    @if(!bounded) { return true; }
}

// Counts fragments that are not to have a node. What has overflowed once stays full.
@if(bounded)
fn count_behind(count: u32) {
    if atomicAdd(&counters.merged, count) > 0xffffffffu - count {
        atomicOr(&counters.merged, 0x80000000u);
    }
}

// With which weight a fragment that has no node counts in the rest.
@if(bounded)
fn rest_weight(index: u32, fragment: Fragment) -> u32 {
    if pool.weighs == 0u || pool.kept == 0u {
        return fragment.alpha;
    }
    let first = nearest_keys[index * pool.kept];
    let last = nearest_keys[index * pool.kept + pool.kept - 1u];
    // Where fewer are there, all are kept, and this one has found no room.
    if last == 0u {
        return fragment.alpha;
    }
    return weight_of(fragment.alpha, fragment.nearness, Nearest(kept_nearness(first), kept_nearness(last), pool.kept));
}

fn store(node: u32, content: Node) {
    @if(more_nodes) {
        if node >= pool.first_nodes {
            more_nodes[node - pool.first_nodes] = content;
            return;
        }
    }
    nodes[node] = content;
}

// Puts a node at the head of the list of a pixel.
fn link(index: u32, node: u32, fragment: Fragment) {
    @if(!bounded) { store(node, pack_node(fragment, atomicExchange(&heads[index], node + 1u))); }
    @if(bounded) { store(node, pack_node(fragment, atomicExchange(&rest[WORDS * index + HEAD], node + 1u))); }
}

fn take(sink: ptr<function, Sink>, pixel: vec2<u32>, fragment: Fragment) {
    let index = pixel.y * view.size.x + pixel.x;
    let kept = is_kept(index, fragment);
    let node = (*sink).first + (*sink).count;
    if kept && (*sink).count < (*sink).room && node < pool.capacity {
        link(index, node, fragment);
    } else {
        // Without a rest, what finds no room leaves the list as it is.
        @if(bounded) {
            if (*sink).stores == 1u {
                add_to_rest(index, fragment, rest_weight(index, fragment));
            }
        }
    }
    (*sink).count += u32(kept);
    (*sink).behind += u32(!kept);
}
