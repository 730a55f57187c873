// A sub-step of a strand of rods: what its rounds begin with, how many there are, and what the next sub-step begins with. Of `direct` and of `direct_near`.

import package::counts::Counts;
import package::eliminate::{Begin, eliminate};
import package::joint::joint_between;
import package::rod::{
    BEGIN, FRAME, HOLDING, LAST_STRAIN, LENGTHS, MOVED, MOVES, Marks, STRAIN, Strand, along, frame_at_rest, half_turn,
    moved_slot, packed_marks, positions, rest, rest_before, rods, slot,
};
import package::rod_near::{Range, no_edge};
@if(colliders)
import package::rod_near::{all_edges, is_any, surface_way};
import package::rod_touch::Found;
@if(contacts)
import package::rod_touch::note_touches;
import package::root::shape_of;
import package::step::step;
import package::substitute::{Aimed, NO_LIMIT, Round, Start, aim_again, inverse_mass, keep_aim, substitute};
import package::take_out::{AT_ONCE, hold_place, hold_stiffness};

@group(0) @binding(5) var<storage, read_write> counts: Counts;

/// Where an edge turns by more than this in the last round, rad, the rounds have not come to their end: the strand's past says little about its
/// future, and its velocities would be what is left undone. It keeps the share of them that this is of the turn. What touches something turns
/// less in a round, and would not slide any more.
const TOO_FAST: f32 = 0.1;
/// There is another round where an edge turns by more than this, rad/s times the length of the sub-step,
const ANOTHER_ROUND: f32 = 4.0;
/// and in sub-steps shorter than this, s, by less, as their square.
const SHORT: f32 = 1.0 / 120.0;

/// Where something is touched, there are at least so many rounds, unless no edge turns by more than `SETTLED`, rad,
const TOUCHING_ROUNDS: u32 = 4u;
/// and at most so many where an edge is deep inside a capsule.
const MOST_ROUNDS: u32 = 16u;
const SETTLED: f32 = 1e-5;

/// The longest rotation of an edge in a round, rad,
const LONGEST_TURN: f32 = 1.5;
/// and that of a strand that touches something: what it touches is another surface after a longer one.
const TOUCHING_TURN: f32 = 0.3;

/// The share of what the spring of a pinned tip leaves that the force which the tip has come to takes up in a sub-step. With all of it, a strand
/// that is pulled taut swings to and fro without end; in those shorter than `AT_ONCE` it is less, in proportion.
const TAKEN_UP: f32 = 0.125;

/// The strand goes to its rest pose, at rest.
fn rest_again(strand: Strand) {
    for (var i = 0u; i < step.vertices; i++) {
        let vertex = rest[i * step.guides + strand.guide];
        positions[i * step.strands + strand.guide] = vec4(shape_of(strand.root, vertex.xyz), vertex.w);
        for (var ago = 0u; ago < MOVES; ago++) { rods[slot(strand, i, MOVED + ago)] = vec4(0.0); }
        if (i > 0u) {
            let frame = frame_at_rest(strand, i);
            rods[slot(strand, i, FRAME)] = frame;
            keep_aim(strand, i, rest_before(strand, i).w, false, Aimed(frame, vec3(0.0)));
        }
    }
    rods[slot(strand, 0u, BEGIN)] = vec4(0.0, 0.0, 0.0, packed_marks(Marks(strand.turn, false, false, false)));
    rods[slot(strand, 0u, LENGTHS)] = vec4(step.length, step.length, f32(step.vertices), 0.0);
    rods[slot(strand, 0u, HOLDING)] = vec4(0.0);
    store_strains(strand, false);
}

/// Moves what the root holds: itself and the vertices after it that are pinned as well.
fn carry_held(strand: Strand) -> Start {
    var start: Start;
    start.moving = strand.root_moved;
    start.parent = strand.root.rotation;
    @if(colliders) {
        start.surface = surface_way(strand);
    }
    rods[moved_slot(strand, 0u, 0u)] = vec4(start.moving, 0.0);
    positions[strand.guide] = vec4(strand.root_now, inverse_mass(strand, 0u));
    for (var vertex = 1u; vertex <= strand.held; vertex++) {
        let length = rest_before(strand, vertex).w;
        start.parent = frame_at_rest(strand, vertex);
        let axis = along(start.parent);
        start.moving += length * (axis - along(rods[slot(strand, vertex, FRAME)]));
        start.place += length * axis;
        rods[moved_slot(strand, vertex, 0u)] = vec4(start.moving, 0.0);
        rods[slot(strand, vertex, FRAME)] = start.parent;
        positions[vertex * step.strands + strand.guide] = vec4(strand.root_now + start.place, inverse_mass(strand, vertex));
    }
    return start;
}

/// What the first round begins with: the guesses, from where the root gets to.
fn first_begin(strand: Strand, start: Start) -> Begin {
    var begin: Begin;
    begin.is_first_round = true;
    begin.parent = start.parent;
    begin.moving = start.moving + rods[slot(strand, 0u, BEGIN)].xyz;
    let tip = positions[strand.edges * step.strands + strand.guide].xyz;
    begin.place = tip - step.center_displacement + begin.moving - strand.root_now;
    @if(colliders) {
        begin.near = all_edges(strand);
        begin.surface = start.surface;
    }
    return begin;
}

/// What the next round begins with.
fn next_begin(strand: Strand, start: Start, round: Round) -> Begin {
    if (round.count == 0u) { return first_begin(strand, start); }
    var begin: Begin;
    begin.parent = start.parent;
    begin.moving = round.moving;
    begin.place = round.place;
    @if(colliders) {
        begin.near = round.near;
        begin.surface = start.surface;
    }
    return begin;
}

/// Where an edge turns by more than this in a round, rad, there is another one.
fn limit_of(round: u32) -> f32 {
    let limit = min(ANOTHER_ROUND * step.length * min(step.length / SHORT, 1.0), TOO_FAST);
    return select(NO_LIMIT, limit, round < step.rounds);
}

/// Whether the last round may not be the end. Where an edge may touch something, the next sweep says; see `is_end`.
fn may_go_on(strand: Strand, round: Round) -> bool {
    // A strand that the root holds as a whole, such as one of no length, makes none.
    if (round.count == 0u) { return strand.held < strand.edges; }
    if (round.count == MOST_ROUNDS) { return false; }
    var more = round.longest > limit_of(round.count);
    @if(contacts) {
        more = more || (is_any(round.near) && round.longest >= SETTLED);
    }
    return more;
}

/// Whether the last round was the end where an edge may touch something, by what the sweep behind it has found.
@if(contacts)
fn is_end(round: Round, found: Found) -> bool {
    return is_calm(round) && !(found.touching && (round.count < TOUCHING_ROUNDS || found.deep));
}

@if(contacts)
fn is_calm(round: Round) -> bool {
    return round.count > 0u && round.longest <= limit_of(round.count);
}

/// Whether the last round is the end unless the sweep behind it finds something that it did not.
@if(contacts)
fn may_be_end(round: Round) -> bool {
    return is_calm(round) && !(round.touching && round.count < TOUCHING_ROUNDS);
}

/// No edge turns by more than this in the round behind a sweep that has found this.
fn longest_turn(found: Found) -> f32 {
    return select(LONGEST_TURN, TOUCHING_TURN, found.touching);
}

/// Whether the sub-step is longer than `SHORT` by more than rounding.
fn is_long() -> bool {
    return step.length > 1.01 * SHORT;
}

/// Whether an edge that comes back twice in a row is guessed to stay where it is. In shorter sub-steps nothing shook, and strands that touch something have other
/// rounds.
fn may_stay(found: Found) -> bool {
    return is_long() && !found.touching;
}

/// All rounds of a sub-step after those that are done; gives what the last one has come to. Where contacts are left to `direct_near`, no
/// more than to where an edge may touch something.
fn rounds(strand: Strand, start: Start, so_far: Round) -> Round {
    var round = so_far;
    while (may_go_on(strand, round)) {
        let begin = next_begin(strand, start, round);
        let found = eliminate(strand, begin);
        @if(colliders && !contacts) {
            if (found.near) {
                round.near = all_edges(strand);
                break;
            }
        }
        @if(contacts) {
            if (is_end(round, found)) { break; }
        }
        let count = round.count + 1u;
        round = substitute(strand, start, begin.is_first_round, longest_turn(found), limit_of(count), may_stay(found));
        round.count = count;
        @if(contacts) {
            round.touching = found.touching;
        }
        @if(colliders && !contacts) {
            if (is_any(round.near)) { break; }
        }
    }
    return round;
}

/// Ends a sub-step. A strand that has become non-finite goes back to its rest pose, and is counted.
fn end(strand: Strand, start: Start, round: Round) {
    if (round.finite) {
        finish(strand, start, round);
    } else {
        rest_again(strand);
        atomicAdd(&counts.non_finite, 1u);
    }
}

/// Whether the last round turned an edge so far that it is not the end.
fn is_too_fast(round: Round) -> bool {
    @if(!contacts) { return round.longest > TOO_FAST; }
    @if(contacts) { return round.longest > TOO_FAST && !round.touching; }
}

/// The share of its velocities past the root that a strand keeps.
fn kept_of(round: Round) -> f32 {
    return select(1.0, TOO_FAST / round.longest, is_too_fast(round));
}

/// Stores the state of the strand that the next sub-step begins with.
fn finish(strand: Strand, start: Start, round: Round) {
    var calm = !is_too_fast(round);
    var near = no_edge();
    @if(contacts) {
        near = round.near;
        calm = !note_touches(strand, near, start.surface) && calm;
    }
    var aimed = round.aimed;
    if (!calm) { aimed = aim_again(strand, kept_of(round)); }
    store_strains(strand, true);
    keep_begin(strand, round, near, calm, aimed);
}

/// Stores what the slots of the root are for.
fn keep_begin(strand: Strand, round: Round, near: Range, calm: bool, aimed: vec3<f32>) {
    keep_hold(strand, round.place, calm);
    let marks = Marks(strand.turn, calm, calm && strand.has_past, strand.had_past);
    let last_length = rods[slot(strand, 0u, LENGTHS)].x;
    rods[slot(strand, 0u, BEGIN)] = vec4(aimed, packed_marks(marks));
    rods[slot(strand, 0u, LENGTHS)] = vec4(step.length, last_length, f32(near.first), f32(near.last));
}

/// Stores the strains of all joints; the ones before them are kept, or are the same.
fn store_strains(strand: Strand, keep: bool) {
    @if(internal_damping) {
        for (var vertex = 1u; vertex < step.vertices; vertex++) { store_strain(strand, vertex, keep); }
    }
}

@if(internal_damping)
fn store_strain(strand: Strand, vertex: u32, keep: bool) {
    var parent = strand.root.rotation;
    if (vertex > 1u) { parent = rods[slot(strand, vertex - 1u, FRAME)]; }
    let frame = rods[slot(strand, vertex, FRAME)];
    let last = rods[slot(strand, vertex, STRAIN)];
    let strain = joint_between(parent, half_turn(rest_before(strand, vertex)), frame).strain;
    rods[slot(strand, vertex, LAST_STRAIN)] = vec4(select(strain, last.xyz, keep), 0.0);
    rods[slot(strand, vertex, STRAIN)] = vec4(strain, last.w);
}

/// The force that a pinned tip has come to takes up some of what the spring leaves; `place` is from the root. Where the rounds have not come to
/// their end, what is left says nothing of the force.
fn keep_hold(strand: Strand, place: vec3<f32>, calm: bool) {
    @if(pinned_tips) {
        let more = hold_stiffness(strand) * (hold_place(strand) - strand.root_now - place);
        let taken_up = TAKEN_UP * min(step.length / AT_ONCE, 1.0);
        if (calm) { rods[slot(strand, 0u, HOLDING)] += vec4(taken_up * more, 0.0); }
    }
}
