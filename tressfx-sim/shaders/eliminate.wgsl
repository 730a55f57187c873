// The sweep of a round from the tip to the root, by one thread.

import package::rod::{Strand, along, row_of};
import package::take_out::{move_to_beginning, system_of_tip, take_out};
import package::terms::{inertia, pulled, terms_of};
@if(contacts)
import package::rod_contact::contacts_of;
@if(colliders)
import package::rod_near::{Range, is_in, near_obstacles, nothing_known, squared_past_head};
import package::rod_touch::Found;
@if(contacts)
import package::rod_touch::{edge_between, last_touch};
@if(contacts)
import package::take_out::add_push;

/// What a round begins with.
struct Begin {
    is_first_round: bool,
    /// What the tip has moved by, and where it is from the root.
    moving: vec3<f32>,
    place: vec3<f32>,
    /// The frame before the first free edge.
    parent: vec4<f32>,
    /// The edges that may touch something.
    @if(colliders) near: Range,
    /// The most that the surface of any collider has moved past the head.
    @if(colliders) surface: f32,
}

/// Gives what it has found where the round begins. Where contacts are for `direct_near`, it ends at the first edge that may touch something.
fn eliminate(strand: Strand, begin: Begin) -> Found {
    var found: Found;
    let tip = strand.edges;
    var row = row_of(strand, tip, begin.is_first_round);
    var next = row_of(strand, tip - 1u, begin.is_first_round);
    var axis = along(row.now);
    var moving = begin.moving;
    var at = begin.place;
    var after_edge = pulled(strand, tip, row, moving);
    var system = system_of_tip(strand, inertia(strand, tip, 0.5 * row.rest.w, after_edge, at, axis), at);
    // Of the edge after the one at hand, which has half of the mass between them.
    var length_after = 0.0;
    @if(colliders) var clear = nothing_known();
    @if(colliders) var past_after = 0.0;
    for (var vertex = tip; vertex > strand.held; vertex--) {
        let length = row.rest.w;
        var length_before = 0.0;
        var parent = begin.parent;
        var direction = axis;
        if (vertex > 1u) {
            length_before = next.rest.w;
            if (vertex > strand.held + 1u) { parent = next.now; }
            direction = along(parent);
        }
        let end_moving = moving;
        let end_at = at;
        moving -= length * row.by;
        at -= length * axis;
        let before_edge = pulled(strand, vertex - 1u, next, moving);
        let arm = length * axis;
        move_to_beginning(&system, arm, axis);
        @if(colliders) {
            if (is_in(begin.near, vertex)) {
                if (vertex == min(begin.near.last, tip)) { past_after = squared_past_head(strand, end_at, end_moving); }
                let past = squared_past_head(strand, at, moving);
                let obstacles = near_obstacles(&clear, begin.surface, max(past, past_after), strand, at, end_at, length);
                past_after = past;
                @if(!contacts) {
                    if (obstacles != 0u) { return Found(true, false, false); }
                }
                @if(contacts) {
                    if (obstacles != 0u) {
                        let mass = 0.5 * (length + length_after);
                        let edge = edge_between(strand, at, end_at, moving, end_moving);
                        let contacts = contacts_of(strand.root_now, edge, last_touch(strand, vertex), obstacles, mass);
                        add_push(&system, arm, contacts.push);
                        found.near = true;
                        found.touching = found.touching || contacts.touch.obstacle > 0u;
                        found.deep = found.deep || contacts.touch.is_deep;
                    }
                }
            }
        }
        length_after = length;
        let terms = terms_of(strand, vertex, row, axis, parent, direction, length_before, after_edge, before_edge, at);
        take_out(&system, strand, vertex, terms);
        after_edge = before_edge;
        axis = direction;
        row = next;
        // Not earlier: that takes registers that there are not.
        next = row_of(strand, max(vertex, 2u) - 2u, begin.is_first_round);
    }
    return found;
}
