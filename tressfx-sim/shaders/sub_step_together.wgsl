// A sub-step of a strand by a group of threads; see `sub_step.wgsl` for what each part does.

import package::constants::TOGETHER;
import package::eliminate_together::eliminate_together;
import package::hand_over::first_listed;
import package::rod::{FRAME, Strand, TURNED, along, moved_slot, rest_before, rods, slot};
import package::rod_near::{all_edges, near_obstacles, nothing_known, squared_past_head};
import package::rod_touch::{end_at, note_touch};
import package::step::step;
import package::sub_step::{
    counts, is_end, is_too_fast, keep_begin, kept_of, limit_of, longest_turn, may_be_end, may_go_on, may_stay, next_begin, rest_again,
};
@if(internal_damping)
import package::sub_step::store_strain;
import package::substitute::{Round, Start, aim_edge_again};
import package::substitute_together::substitute_together;
import package::together::{Sums, any_wants, member, sum_up_to, total};
import package::vector::is_finite;

/// What the rounds have come to that `direct` has done.
fn listed_round_together(strand: Strand, start: Start, place: u32, lane: u32) -> Round {
    var round = first_listed(start, place);
    var way = Sums(vec3(0.0), vec3(0.0));
    if (round.count > 0u) {
        for (var vertex = strand.held + 1u + member(lane); vertex <= strand.edges; vertex += TOGETHER) {
            let length = rest_before(strand, vertex).w;
            way.a += length * rods[slot(strand, vertex, TURNED)].xyz;
            way.b += length * along(rods[slot(strand, vertex, FRAME)]);
        }
    }
    sum_up_to(lane, way);
    let all = total(lane);
    round.moving += all.a;
    round.place += all.b;
    round.finite = is_finite(round.place) && is_finite(round.moving);
    return round;
}

/// `is_listed` says whether the strand is one of the list; others are not touched.
fn rounds_together(strand: Strand, start: Start, so_far: Round, lane: u32, is_listed: bool) -> Round {
    var round = so_far;
    var goes_on = is_listed;
    var has_looked = false;
    loop {
        goes_on = goes_on && may_go_on(strand, round);
        if (!any_wants(lane, goes_on)) { break; }
        // Where all strands may have come to their ends, edges only look at what they touch at first.
        let looks = !has_looked && !any_wants(lane, goes_on && !may_be_end(round));
        let begin = next_begin(strand, start, round);
        let found = eliminate_together(strand, begin, lane, goes_on, looks);
        goes_on = goes_on && !is_end(round, found);
        has_looked = looks;
        if (looks) { continue; }
        if (!any_wants(lane, goes_on)) { break; }
        let count = round.count + 1u;
        let most = longest_turn(found);
        let next = substitute_together(strand, start, begin.is_first_round, most, limit_of(count), may_stay(found), lane, goes_on);
        if (goes_on) {
            round = next;
            round.count = count;
            round.touching = found.touching;
        }
    }
    return round;
}

fn end_together(strand: Strand, start: Start, round: Round, lane: u32, is_listed: bool) {
    let is_sound = is_listed && round.finite;
    finish_together(strand, start, round, lane, is_sound);
    if (is_listed && !is_sound && member(lane) == 0u) {
        rest_again(strand);
        atomicAdd(&counts.non_finite, 1u);
    }
}

fn finish_together(strand: Strand, start: Start, round: Round, lane: u32, is_sound: bool) {
    let is_new = note_touches_together(strand, start.surface, lane, is_sound);
    // What one thread has noted of an edge another one reads with its strain.
    storageBarrier();
    let calm = !is_too_fast(round) && !is_new;
    var aimed = round.aimed;
    if (any_wants(lane, is_sound && !calm)) {
        let again = aim_again_together(strand, kept_of(round), lane, is_sound && !calm);
        aimed = select(again, aimed, calm);
    }
    if (!is_sound) { return; }
    @if(internal_damping) {
        for (var vertex = 1u + member(lane); vertex < step.vertices; vertex += TOGETHER) { store_strain(strand, vertex, true); }
    }
    if (member(lane) == 0u) { keep_begin(strand, round, all_edges(strand), calm, aimed); }
}

fn note_touches_together(strand: Strand, surface: f32, lane: u32, is_sound: bool) -> bool {
    var new_ones = 0.0;
    for (var vertex = strand.held + 1u + member(lane); is_sound && vertex <= strand.edges; vertex += TOGETHER) {
        let u = end_at(strand, vertex - 1u);
        let v = end_at(strand, vertex);
        let past = max(squared_past_head(strand, u.at, u.moved), squared_past_head(strand, v.at, v.moved));
        var clear = nothing_known();
        let obstacles = near_obstacles(&clear, surface, past, strand, u.at, v.at, rest_before(strand, vertex).w);
        if (note_touch(strand, vertex, u, v, obstacles)) { new_ones += 1.0; }
    }
    sum_up_to(lane, Sums(vec3(new_ones, 0.0, 0.0), vec3(0.0)));
    return total(lane).a.x > 0.0;
}

/// From the tip to the root, so that each edge finds the vertex before it as it was.
fn aim_again_together(strand: Strand, kept: f32, lane: u32, is_due: bool) -> vec3<f32> {
    var aimed = vec3(0.0);
    let held = rods[moved_slot(strand, strand.held, 0u)].xyz;
    for (var first = 0u; first + 1u < step.vertices; first += TOGETHER) {
        let place = first + member(lane);
        let is_free = is_due && place < strand.edges - strand.held;
        let vertex = select(1u, strand.edges - place, is_free);
        let moved = rods[moved_slot(strand, vertex, 0u)];
        let before = rods[moved_slot(strand, vertex - 1u, 0u)].xyz;
        storageBarrier();
        if (is_free) { aimed += aim_edge_again(strand, vertex, moved, before, held, kept); }
    }
    sum_up_to(lane, Sums(aimed, vec3(0.0)));
    return total(lane).a;
}
