// The sweep of a round from the tip to the root, by a group of threads: what edges bring in is found by all of them, an edge each, and one thread takes
// the edges out in turn.

import package::constants::TOGETHER;
import package::eliminate::Begin;
import package::rod::{Row, Strand, along, rest_before, row_of};
import package::rod_contact::{Push, contacts_of};
import package::rod_near::{near_obstacles, nothing_known, squared_past_head};
import package::rod_touch::{Found, edge_between, last_touch};
import package::step::step;
import package::take_out::{System, add_push, move_to_beginning, system_of_tip, take_out};
import package::terms::{Terms, inertia, pulled, terms_of};
import package::together::{LANES, Sums, bits_of_strand, member, sum_up_to, total};

/// What an edge brings in; a push where it is near something. See `IS_NEAR`.
struct Brought { terms: Terms, push: Push, found: u32 }

const IS_NEAR: u32 = 1u;
const IS_TOUCHING: u32 = 2u;
const IS_DEEP: u32 = 4u;

var<workgroup> brought: array<Brought, LANES>;

/// An edge where a round begins: the rows of both vertices, and what they have moved by and where they are from the root.
struct Placed { row: Row, row_before: Row, moving: vec3<f32>, at: vec3<f32>, end_moving: vec3<f32>, end_at: vec3<f32> }

/// Gives all threads of a strand what it has found where the round begins; nothing is done for a strand that has come to its end. Each edge asks for itself what
/// it may touch; where it only `looks`, nothing else is done.
fn eliminate_together(strand: Strand, begin: Begin, lane: u32, goes_on: bool, looks: bool) -> Found {
    let tip = row_of(strand, strand.edges, begin.is_first_round);
    let pulled_tip = pulled(strand, strand.edges, tip, begin.moving);
    let last = inertia(strand, strand.edges, 0.5 * tip.rest.w, pulled_tip, begin.place, along(tip.now));
    var system = system_of_tip(strand, last, begin.place);
    var moving = begin.moving;
    var at = begin.place;
    var found = 0u;
    for (var first = 0u; first + 1u < step.vertices; first += TOGETHER) {
        let place = first + member(lane);
        let is_free = goes_on && place < strand.edges - strand.held;
        let vertex = select(1u, strand.edges - place, is_free);
        let row = row_of(strand, vertex, begin.is_first_round);
        let length = select(0.0, row.rest.w, is_free);
        let way = Sums(length * row.by, length * along(row.now));
        let beyond = sum_up_to(lane, way);
        let row_before = row_of(strand, vertex - 1u, begin.is_first_round);
        let placed = Placed(row, row_before, moving - beyond.a, at - beyond.b, moving - beyond.a + way.a, at - beyond.b + way.b);
        let all = total(lane);
        moving -= all.a;
        at -= all.b;
        if (is_free) {
            let touched = touch(strand, begin, lane, vertex, placed);
            found |= touched;
            brought[lane].found = touched;
            if (!looks) { bring(strand, begin, lane, vertex, placed); }
        }
        if (looks) { continue; }
        workgroupBarrier();
        if (goes_on && member(lane) == 0u) { take_out_all(&system, strand, first, lane); }
        workgroupBarrier();
    }
    // What one thread has left of an edge another one reads.
    storageBarrier();
    let bits = bits_of_strand(lane, found);
    return Found((bits & IS_NEAR) != 0u, (bits & IS_TOUCHING) != 0u, (bits & IS_DEEP) != 0u);
}

/// Finds what the edge before a vertex brings in.
fn bring(strand: Strand, begin: Begin, lane: u32, vertex: u32, placed: Placed) {
    let row = placed.row;
    let axis = along(row.now);
    var parent = begin.parent;
    var direction = axis;
    var length_before = 0.0;
    if (vertex > 1u) {
        length_before = placed.row_before.rest.w;
        if (vertex > strand.held + 1u) { parent = placed.row_before.now; }
        direction = along(parent);
    }
    let after = pulled(strand, vertex, row, placed.end_moving);
    let before = pulled(strand, vertex - 1u, placed.row_before, placed.moving);
    brought[lane].terms = terms_of(strand, vertex, row, axis, parent, direction, length_before, after, before, placed.at);
}

/// Finds what it touches.
fn touch(strand: Strand, begin: Begin, lane: u32, vertex: u32, placed: Placed) -> u32 {
    let length = placed.row.rest.w;
    let past = max(squared_past_head(strand, placed.at, placed.moving), squared_past_head(strand, placed.end_at, placed.end_moving));
    var clear = nothing_known();
    let obstacles = near_obstacles(&clear, begin.surface, past, strand, placed.at, placed.end_at, length);
    if (obstacles == 0u) { return 0u; }
    var length_after = 0.0;
    if (vertex < strand.edges) { length_after = rest_before(strand, vertex + 1u).w; }
    let edge = edge_between(strand, placed.at, placed.end_at, placed.moving, placed.end_moving);
    let contacts = contacts_of(strand.root_now, edge, last_touch(strand, vertex), obstacles, 0.5 * (length + length_after));
    brought[lane].push = contacts.push;
    return IS_NEAR | select(0u, IS_TOUCHING, contacts.touch.obstacle > 0u) | select(0u, IS_DEEP, contacts.touch.is_deep);
}

/// Takes out the edges of all threads of a strand, of which `lane` is the first. The first edge is so many before the tip.
fn take_out_all(system: ptr<function, System>, strand: Strand, first: u32, lane: u32) {
    let free = strand.edges - strand.held;
    for (var i = lane; i < lane + min(TOGETHER, free - min(free, first)); i++) {
        let arm = brought[i].terms.length * brought[i].terms.axis;
        move_to_beginning(system, arm, brought[i].terms.axis);
        if (brought[i].found != 0u) { add_push(system, arm, brought[i].push); }
        take_out(system, strand, strand.edges - first - (i - lane), brought[i].terms);
    }
}
