// The sweep of a round from the root to the tip, by a group of threads: one finds the rotations of the edges in turn, and all of them turn an edge each.

import package::constants::TOGETHER;
import package::left::Packed;
import package::rod::{Strand, along, moved_slot, rods, speed_of};
import package::rod_near::all_edges;
import package::step::step;
import package::substitute::{Carried, Round, Start, hung, keep_place, keep_turned, nothing_done, turn_next, turned};
import package::together::{LANES, Sums, member, sum_up_to, total};
import package::vector::is_finite;

/// What it takes to turn an edge, and then its rotation.
struct Link { left: Packed, direction: vec3<f32>, length: f32, turn: vec3<f32> }

var<workgroup> links: array<Link, LANES>;
/// The longest rotation so far, rad, of the strand of each first thread.
var<workgroup> longest: array<f32, LANES>;

/// The same as `substitute`, for all threads; nothing is kept of a strand that has come to its end. Nothing is asked for edges that may touch something: each sweep to
/// the root does.
fn substitute_together(strand: Strand, start: Start, is_first_round: bool, most: f32, limit: f32, may_stay: bool, lane: u32,
                       goes_on: bool) -> Round {
    var round = nothing_done(start);
    var carried: Carried;
    var aimed = vec3(0.0);
    let speed = speed_of(strand.has_past, 1.0);
    for (var first = 0u; first + 1u < step.vertices; first += TOGETHER) {
        let vertex = strand.held + 1u + first + member(lane);
        let is_free = goes_on && vertex <= strand.edges;
        let here = hung(strand, min(vertex, strand.edges), is_first_round);
        let moved_before = rods[moved_slot(strand, min(vertex, strand.edges) - 1u, 1u)].xyz;
        let length = select(0.0, abs(here.by.w), is_free);
        links[lane] = Link(here.left, along(here.now), length, vec3(0.0));
        workgroupBarrier();
        if (member(lane) == 0u) { turn_all(&carried, strand, first, most, lane); }
        workgroupBarrier();
        let so_far = longest[lane - member(lane)];
        let turned = turned(here, links[lane].turn);
        let none = vec3(0.0);
        let own = Sums(select(none, length * turned.by, is_free), select(none, length * along(turned.now), is_free));
        let way = sum_up_to(lane, own);
        let moving = round.moving + way.a;
        let place = round.place + way.b;
        if (is_free) { keep_turned(strand, vertex, here, turned); }
        if (is_free && so_far <= limit) {
            let by_moved = here.moved.xyz - moved_before;
            let apart = speed.x * own.a + speed.y * by_moved;
            let swings_back = dot(turned.by, by_moved) < 0.0;
            aimed += keep_place(strand, vertex, here, turned, place, moving, apart, swings_back, may_stay);
        }
        let all = total(lane);
        round.moving += all.a;
        round.place += all.b;
        round.longest = so_far;
    }
    sum_up_to(lane, Sums(aimed, vec3(0.0)));
    round.aimed = total(lane).a;
    round.near = all_edges(strand);
    round.finite = is_finite(round.place) && is_finite(round.moving);
    // The next sweep has other edges for each thread.
    storageBarrier();
    return round;
}

/// Finds the rotations of the edges of all threads of a strand, of which `lane` is the first. The first edge is so many behind the first free one.
fn turn_all(carried: ptr<function, Carried>, strand: Strand, first: u32, most: f32, lane: u32) {
    let free = strand.edges - strand.held;
    for (var i = 0u; i < min(TOGETHER, free - min(free, first)); i++) {
        let link = links[lane + i];
        turn_next(carried, strand, link.left, link.length, link.direction, most);
        links[lane + i].turn = (*carried).turn;
    }
    longest[lane] = (*carried).longest;
}
