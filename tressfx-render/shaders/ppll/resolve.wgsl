// The list of each pixel becomes one colour. The K nearest fragments are put in order, the rest, its tail, is summed up in
// integers: with its colours, or, unshaded, with its opacities alone, or not at all. Where colours are weighted by what is seen of them, a list is gone
// through once more. Where lists are bounded, the rest that has
// no nodes begins the tail.
//
// The order of a list changes from run to run with the order of the atomics; the result does not, to the bit: fragments
// are sorted under a total order, and sums of integers know no order.

import package::constants::K;
import package::fragment::{OPAQUE, packed_alpha, packed_color};
import package::front::{Front, nothing_yet, over, passes};
import package::node::{Content, NOTHING, Node, PoolUniform, content_of, next_of};
import package::pixels::{count_hairy, counters, index_of, is_inside, pixel_of, view};
import package::rest::UNIT;
import package::sums::{FULL, optical_depth, transmittance_of};
import package::tile::tile_of;

@if(bounded)
import package::rest::{HEAD, WORDS};
@if(bounded && hair_output)
import package::rest::KEY;
@if(hair_output || weighted)
import package::fragment::nearness_of;
@if(hair_output)
import package::fragment::seen_key;
@if(hair_output)
import package::pixels::write_seen_pixel;
@if(!hair_output)
import package::pixels::write_pixel;
@if(places)
import package::places::{all_places, parts_of, strength_of, unpack_stripe};
@if(shaded)
import package::sums::{mean_color, weighted};
@if(weighted)
import package::weight::{Nearest, weight_of};

@group(0) @binding(1) var<uniform> pool: PoolUniform;
@if(!bounded)
@group(0) @binding(2) var<storage, read> heads: array<u32>;
@group(0) @binding(3) var<storage, read> nodes: array<Node>;
@if(more_nodes)
@group(0) @binding(9) var<storage, read> more_nodes: array<Node>;
@if(bounded)
@group(0) @binding(8) var<storage, read> rest: array<u32>;

// An array has at least one element, and the one of K = 0 is never looked at.
const ROOM: u32 = max(K, 1u);
@if(!places)
const FAR: Content = vec3(0xffffffffu, 0u, 0u);
@if(places)
const FAR: Content = vec4(0xffffffffu, 0u, 0u, 0u);

// What lies behind the K nearest.
struct Tail {
    // Sum of -log2(1 - alpha).
    optical: u32,
    // Sum of the weights of the colours.
    weight: u32,
    color: vec3<u32>,
}

@if(!places)
fn is_before(a: Content, b: Content) -> bool {
    return (a.x < b.x) | ((a.x == b.x) & ((a.y < b.y) | ((a.y == b.y) & (a.z < b.z))));
}

@if(places)
fn is_before(a: Content, b: Content) -> bool {
    return (a.x < b.x) | ((a.x == b.x) & ((a.y < b.y) | ((a.y == b.y) & ((a.z < b.z) | ((a.z == b.z) & (a.w < b.w))))));
}

// The node of a number; of that of no node the first one.
fn node_of(number: u32) -> Node {
    let place = max(number, 1u) - 1u;
    @if(more_nodes) {
        if place >= pool.first_nodes {
            return more_nodes[place - pool.first_nodes];
        }
    }
    return nodes[place];
}

fn add_opacity(tail: ptr<function, Tail>, node: Content) {
    (*tail).optical = min((*tail).optical + optical_depth(packed_alpha(node.yz)), FULL);
}

fn add_color(tail: ptr<function, Tail>, node: Content, weight: u32) {
    (*tail).weight = min((*tail).weight + weight, FULL);
    @if(shaded) {
        (*tail).color = min((*tail).color + weighted(packed_color(node.yz), weight, UNIT), vec3(FULL));
    }
}

fn add(tail: ptr<function, Tail>, node: Content) {
    add_opacity(tail, node);
    // Weights are known when the nearest are.
    @if(!weighted) { add_color(tail, node, packed_alpha(node.yz)); }
}

// The colours of a list that has more fragments than the nearest, each with its weight. The nearest have their alpha for a weight, and are taken out
// of the sums again: so it is the same which of several that are the same is one of them.
@if(weighted)
fn add_weighted(tail: ptr<function, Tail>, head: u32, nearest: ptr<function, array<Content, ROOM>>) {
    // Their number is read where the fill reads it: with a constant, compilers round what is computed from it in another way.
    let extent = Nearest(nearness_of((*nearest)[0].x), nearness_of((*nearest)[ROOM - 1u].x), pool.sorted);
    var all: Tail;
    var next = head;
    while next != NOTHING {
        let node = node_of(next);
        let content = content_of(node);
        next = next_of(node);
        let is_behind = K > 0u && is_before((*nearest)[ROOM - 1u], content);
        let alpha = packed_alpha(content.yz);
        add_color(&all, content, select(alpha, weight_of(alpha, nearness_of(content.x), extent), is_behind));
    }
    var own: Tail;
    for (var i = 0u; i < K; i++) {
        add_color(&own, (*nearest)[i], packed_alpha((*nearest)[i].yz));
    }
    // A tail has a weight, also where a driver of a CPU has ended the loop, see `turns`.
    (*tail).weight = clamp((*tail).weight + all.weight - min(own.weight, all.weight), 1u, FULL);
    (*tail).color = min((*tail).color + all.color - min(own.color, all.color), vec3(FULL));
}

// The colour of a tail with a weight.
fn tail_color(tail: Tail) -> vec3<f32> {
    @if(shaded) { return mean_color(tail.color, tail.weight, UNIT); }
    @if(!shaded) { return pool.unlit.rgb; }
}

fn over_node(front: Front, node: Content) -> Front {
    let alpha = f32(packed_alpha(node.yz)) / OPAQUE;
    @if(!places) { return over(front, packed_color(node.yz), alpha, 1u); }
    @if(places) {
        let stripe = unpack_stripe(node.w);
        return over(front, packed_color(node.yz), parts_of(stripe, strength_of(stripe, alpha), 0u), 1u);
    }
}

// A tail covers all places alike.
fn over_tail(front: Front, tail: Tail) -> Front {
    let alpha = 1.0 - transmittance_of(tail.optical);
    @if(!places) { return over(front, tail_color(tail), alpha, 1u); }
    @if(places) { return over(front, tail_color(tail), all_places(alpha), 1u); }
}

fn blend(nearest: ptr<function, array<Content, ROOM>>, tail: Tail) -> vec4<f32> {
    var front = nothing_yet();
    for (var i = 0u; i < K; i++) {
        front = over_node(front, (*nearest)[i]);
    }
    if tail.weight > 0u {
        front = over_tail(front, tail);
    }
    return vec4(front.color, 1.0 - passes(front));
}

// What the fragments of a pixel without nodes have left.
fn rest_of(index: u32) -> Tail {
    var tail: Tail;
    @if(bounded) {
        let first = WORDS * index;
        tail.optical = min(rest[first], FULL);
        tail.weight = min(rest[first + 1u], FULL);
        tail.color = min(vec3(rest[first + 2u], rest[first + 3u], rest[first + 4u]), vec3(FULL));
    }
    return tail;
}

// Puts a node at its place among the nearest; returns the one that falls out. It goes up, so that compilers unroll it: with the array in memory it takes
// twice as long on a CPU.
fn insert(nearest: ptr<function, array<Content, ROOM>>, node: Content) -> Content {
    var passed = node;
    for (var i = 0u; i < ROOM; i++) {
        let here = (*nearest)[i];
        let is_first = is_before(passed, here);
        (*nearest)[i] = select(here, passed, is_first);
        passed = select(passed, here, is_first);
    }
    return passed;
}

fn resolve_list(head: u32, behind: Tail) -> vec4<f32> {
    var nearest: array<Content, ROOM>;
    for (var i = 0u; i < ROOM; i++) {
        nearest[i] = FAR;
    }
    var tail: Tail;
    @if(shaded || unshaded) { tail = behind; }
    // The next node is fetched before this one is looked at: the time is that of waiting for memory.
    var node = node_of(head);
    var next = head;
    @if(weighted)
    var length = 0u;
    while next != NOTHING {
        next = next_of(node);
        @if(weighted) { length++; }
        var passed = content_of(node);
        node = node_of(next);
        if K > 0u && is_before(passed, nearest[ROOM - 1u]) {
            passed = insert(&nearest, passed);
        }
        @if(shaded || unshaded) { add(&tail, passed); }
    }
    @if(weighted) {
        if length > K {
            add_weighted(&tail, head, &nearest);
        }
    }
    return blend(&nearest, tail);
}

// The key of the nearest fragment of a pixel, whether or not it has a node.
@if(hair_output)
fn nearest_seen(index: u32, head: u32) -> u32 {
    var seen = 0u;
    @if(bounded) { seen = rest[WORDS * index + KEY]; }
    var next = head;
    while next != NOTHING {
        let node = node_of(next);
        let content = content_of(node);
        next = next_of(node);
        seen = max(seen, seen_key(nearness_of(content.x), packed_alpha(content.yz)));
    }
    return seen;
}

// What the whole view has left: one thread comes here.
fn count_fragments() {
    let wanted = atomicLoad(&counters.fragments);
    let without_node = max(wanted, pool.capacity) - pool.capacity;
    counters.wanted = wanted;
    counters.saturated = u32(wanted >= pool.limit);
    @if(!bounded) { atomicStore(&counters.dropped, without_node); }
    @if(bounded) {
        let behind = atomicLoad(&counters.merged);
        counters.saturated = u32(wanted >= pool.limit || behind > FULL);
        atomicStore(&counters.fragments, min(wanted, FULL) + min(behind, FULL));
        atomicStore(&counters.merged, without_node + select(0u, min(behind, FULL), pool.kept < pool.asked));
    }
}

@compute @workgroup_size(8, 8)
fn resolve(@builtin(global_invocation_id) thread: vec3<u32>, @builtin(workgroup_id) group: vec3<u32>,
           @builtin(local_invocation_index) lane: u32) {
    let pixel = pixel_of(thread.xy);
    let inside = is_inside(pixel);
    let index = index_of(pixel);
    var head = NOTHING;
    var behind: Tail;
    if inside {
        @if(!bounded) { head = heads[index]; }
        @if(bounded) { head = rest[WORDS * index + HEAD]; }
        behind = rest_of(index);
    }
    let has_hair = head != NOTHING || behind.weight > 0u;
    let count = count_hairy(has_hair, tile_of(pixel, view.size), lane);
    if lane == 0u && all(group.xy == vec2(0u)) {
        count_fragments();
    }
    if inside && count > 0u {
        var color = vec4(0.0);
        if has_hair {
            color = resolve_list(head, behind);
        }
        @if(!hair_output) { write_pixel(pixel, color); }
        @if(hair_output) { write_seen_pixel(pixel, color, nearest_seen(index, head)); }
    }
}
