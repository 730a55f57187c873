// How `direct` leaves a strand to `direct_near`: in a list, with the rounds that it has done. All else of the sub-step so far is in the slots of the strand.

import package::rod::{FRAME, LISTED, SO_FAR, Strand, TURNED, along, frame_at_rest, moved_slot, rest_before, rods, slot, slot_of, strand_of};
import package::rod_near::{Range, surface_way};
import package::sub_step::counts;
import package::substitute::{Round, Start, nothing_done};
import package::vector::is_finite;

/// Puts a strand into the list.
fn hand_over(strand: Strand, round: Round) {
    let place = atomicAdd(&counts.near, 1u);
    rods[slot_of(place, 0u, LISTED)] = vec4(f32(strand.guide), f32(round.count), f32(round.near.first), f32(round.near.last));
    rods[slot_of(place, 0u, SO_FAR)] = vec4(round.aimed, round.longest);
}

/// A strand of the list.
fn listed_strand(place: u32) -> Strand {
    var strand = strand_of(u32(rods[slot_of(place, 0u, LISTED)].x));
    // The root is already where it gets to.
    strand.root_moved = rods[moved_slot(strand, 0u, 0u)].xyz;
    return strand;
}

/// What its first free edge hangs on.
fn listed_start(strand: Strand) -> Start {
    var start: Start;
    start.moving = rods[moved_slot(strand, strand.held, 0u)].xyz;
    start.parent = strand.root.rotation;
    start.surface = surface_way(strand);
    for (var vertex = 1u; vertex <= strand.held; vertex++) {
        start.parent = frame_at_rest(strand, vertex);
        start.place += rest_before(strand, vertex).w * along(start.parent);
    }
    return start;
}

/// What its rounds have come to, but for the sums along the strand.
fn first_listed(start: Start, place: u32) -> Round {
    var round = nothing_done(start);
    let listed = rods[slot_of(place, 0u, LISTED)];
    let so_far = rods[slot_of(place, 0u, SO_FAR)];
    round.count = u32(listed.y);
    if (round.count > 0u) {
        round.near = Range(u32(listed.z), u32(listed.w));
        round.aimed = so_far.xyz;
        round.longest = so_far.w;
    }
    return round;
}

/// All of it.
fn listed_round(strand: Strand, start: Start, place: u32) -> Round {
    var round = first_listed(start, place);
    if (round.count == 0u) { return round; }
    for (var vertex = strand.held + 1u; vertex <= strand.edges; vertex++) {
        let length = rest_before(strand, vertex).w;
        round.moving += length * rods[slot(strand, vertex, TURNED)].xyz;
        round.place += length * along(rods[slot(strand, vertex, FRAME)]);
    }
    round.finite = is_finite(round.place) && is_finite(round.moving);
    return round;
}
