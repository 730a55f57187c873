// A rod whose edges turn and never stretch, in one implicit sub-step: the rotations of all edges of a strand are found at once, by
// Newton's method with elimination from the tip to the root and back. One thread a guide. Forces are per mass of unit length, and
// times the square of the sub-step.

import package::eliminate::{Begin, eliminate, hold_place, hold_stiffness};
import package::grid::{GROUP, thread_index};
import package::joint::joint_between;
import package::rod::{
    BEGIN, FRAME, HOLDING, LAST_STRAIN, LENGTHS, MOVED, MOVES, Marks, STRAIN, Strand, along, frame_at_rest, half_turn,
    moved_slot, packed_marks, positions, rest, rest_before, rods, slot, strand_of,
};
import package::root::shape_of;
import package::step::step;
import package::substitute::{Aimed, NO_AIM_AT_ROOT, Round, Start, aim, aim_again, keep_aim, nothing_done, substitute};
import package::vector::is_finite;
@if(contacts)
import package::rod_touch::{Range, note_touches, surface_way};

/// Strands that were reset because they had become non-finite.
@group(0) @binding(5) var<storage, read_write> non_finite: atomic<u32>;

/// Where an edge turns by more than this in the last round, rad, the strand's past says little about its future.
const TOO_FAST: f32 = 0.5;
/// There is another round where an edge turns by more than this, rad/s times the length of the sub-step,
const ANOTHER_ROUND: f32 = 2.0;
/// and in sub-steps shorter than this, s, by less, as their square.
const SHORT: f32 = 1.0 / 120.0;

/// Where something is touched, there are at least so many rounds, unless no edge turns by more than `SETTLED`, rad,
const TOUCHING_ROUNDS: u32 = 4u;
/// and at most so many where an edge is deep inside a capsule. It is also the most that a strand may ask for.
const MOST_ROUNDS: u32 = 8u;
const SETTLED: f32 = 1e-5;

/// The share of what the spring of a pinned tip leaves that the force which the tip has come to takes up in a sub-step. With all of it, a strand
/// that is pulled taut swings to and fro without end.
const TAKEN_UP: f32 = 0.125;

@compute @workgroup_size(GROUP)
fn direct(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= step.guides) { return; }
    let strand = strand_of(guide);
    if (step.reset != 0u) {
        rest_again(strand);
        return;
    }
    let start = carry_held(strand);
    let round = rounds(strand, start);
    if (round.finite) {
        finish(strand, round);
    } else {
        rest_again(strand);
        atomicAdd(&non_finite, 1u);
    }
}

/// The strand goes to its rest pose, at rest.
fn rest_again(strand: Strand) {
    for (var i = 0u; i < step.vertices; i++) {
        let vertex = rest[i * step.guides + strand.guide];
        positions[i * step.strands + strand.guide] = vec4(shape_of(strand.root, vertex.xyz), vertex.w);
        for (var ago = 0u; ago < MOVES; ago++) { rods[slot(strand, i, MOVED + ago)] = vec4(0.0, 0.0, 0.0, vertex.w); }
        if (i > 0u) {
            let frame = frame_at_rest(strand, i);
            rods[slot(strand, i, FRAME)] = frame;
            keep_aim(strand, i, 0.0, Aimed(frame, vec3(0.0)));
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
    @if(contacts) {
        start.surface = surface_way(strand);
    }
    let mass = rods[moved_slot(strand, 0u, 1u)].w;
    rods[moved_slot(strand, 0u, 0u)] = vec4(start.moving, mass);
    positions[strand.guide] = vec4(strand.root_now, mass);
    for (var vertex = 1u; vertex <= strand.held; vertex++) {
        let length = rest_before(strand, vertex).w;
        start.parent = frame_at_rest(strand, vertex);
        let axis = along(start.parent);
        start.moving += length * (axis - along(rods[slot(strand, vertex, FRAME)]));
        start.place += length * axis;
        let mass = rods[moved_slot(strand, vertex, 1u)].w;
        rods[moved_slot(strand, vertex, 0u)] = vec4(start.moving, mass);
        rods[slot(strand, vertex, FRAME)] = start.parent;
        positions[vertex * step.strands + strand.guide] = vec4(strand.root_now + start.place, mass);
    }
    return start;
}

/// What the first round begins with. Of the guess only the first free edge asks where the root is.
fn first_begin(strand: Strand, start: Start) -> Begin {
    let vertex = strand.held + 1u;
    let frame = rods[slot(strand, vertex, FRAME)];
    let moved = rods[moved_slot(strand, vertex, 1u)].xyz;
    let before = rods[moved_slot(strand, vertex, 2u)].xyz;
    let length = rest_before(strand, vertex).w;
    let apart = strand.speed.x * moved + strand.speed.y * before - start.moving;
    let aimed = aim(frame, length, apart, NO_AIM_AT_ROOT);
    var begin: Begin;
    begin.is_first_round = true;
    begin.parent = start.parent;
    begin.moving = start.moving + keep_aim(strand, vertex, length, aimed) + rods[slot(strand, 0u, BEGIN)].xyz;
    let tip = positions[strand.edges * step.strands + strand.guide].xyz;
    begin.place = tip - step.center_displacement + begin.moving - strand.root_now;
    @if(contacts) {
        begin.near = Range(vertex, strand.edges);
        begin.surface = start.surface;
    }
    return begin;
}

/// All rounds of a sub-step; gives what the last one has come to.
fn rounds(strand: Strand, start: Start) -> Round {
    var round = nothing_done(start);
    // A strand that the root holds as a whole, such as one of no length.
    if (strand.held >= strand.edges) { return round; }
    let calm = ANOTHER_ROUND * step.length * min(step.length / SHORT, 1.0);
    var begin = first_begin(strand, start);
    for (var count = 1u; count <= MOST_ROUNDS; count++) {
        eliminate(strand, begin);
        let limit = select(1e9, calm, count < step.rounds);
        round = substitute(strand, start, begin.is_first_round, limit);
        var goes_on = round.longest > limit;
        @if(contacts) {
            let touching = round.found.touching && round.longest >= SETTLED;
            goes_on = goes_on || (touching && (count < TOUCHING_ROUNDS || round.found.deep));
            begin.near = round.found.near;
        }
        if (!goes_on) { break; }
        begin.is_first_round = false;
        begin.moving = round.moving;
        begin.place = round.place;
    }
    return round;
}

/// Stores the state of the strand that the next sub-step begins with.
fn finish(strand: Strand, round: Round) {
    var calm = round.longest < TOO_FAST;
    var near = vec2(f32(step.vertices), 0.0);
    @if(contacts) {
        let is_new = note_touches(strand, round.found.near);
        calm = calm && !is_new;
        near = vec2(f32(round.found.near.first), f32(round.found.near.last));
    }
    var aimed = round.aimed;
    if (!calm && strand.has_past) { aimed = aim_again(strand); }
    keep_hold(strand, round.place, calm);
    store_strains(strand, true);
    let marks = Marks(strand.turn, calm, calm && strand.has_past, strand.had_past);
    let last_length = rods[slot(strand, 0u, LENGTHS)].x;
    rods[slot(strand, 0u, BEGIN)] = vec4(aimed, packed_marks(marks));
    rods[slot(strand, 0u, LENGTHS)] = vec4(step.length, last_length, near);
}

/// Stores the strains of all joints; the ones before them are kept, or are the same.
fn store_strains(strand: Strand, keep: bool) {
    @if(internal_damping) {
        var parent = strand.root.rotation;
        for (var vertex = 1u; vertex < step.vertices; vertex++) {
            let frame = rods[slot(strand, vertex, FRAME)];
            let last = rods[slot(strand, vertex, STRAIN)];
            let strain = joint_between(parent, half_turn(rest_before(strand, vertex)), frame).strain;
            rods[slot(strand, vertex, LAST_STRAIN)] = vec4(select(strain, last.xyz, keep), 0.0);
            rods[slot(strand, vertex, STRAIN)] = vec4(strain, last.w);
            parent = frame;
        }
    }
}

/// The force that a pinned tip has come to takes up some of what the spring leaves; `place` is from the root. Where the rounds have not come to
/// their end, what is left says nothing of the force.
fn keep_hold(strand: Strand, place: vec3<f32>, calm: bool) {
    @if(pinned_tips) {
        let more = hold_stiffness(strand) * (hold_place(strand) - strand.root_now - place);
        if (calm) { rods[slot(strand, 0u, HOLDING)] += vec4(TAKEN_UP * more, 0.0); }
    }
}
