// One edge taken out of the system: what it and all beyond it want is given to the vertex before it and to its parent. That is half of a quadratic function
// of the displacement of a vertex and of the rotation of the edge before it.

import package::joint::{by_spring, spring_by, stiffness_of, torque_by};
import package::left::{Left, scale_of, store_left};
import package::rod::{HOLDING, Strand, rest, rods, slot};
@if(contacts)
import package::rod_contact::Push;
import package::root::shape_of;
import package::step::step;
import package::symmetric::{
    Symmetric, cross_columns, factors_of, outer, scaled, scaled_identity, solved, solved_columns, sum, symmetric, symmetric_product,
    times, trace, whole, with_transpose,
};
import package::terms::{Inertia, Terms};

/// How stiff the spring is that holds a pinned tip, over the mass that hangs on it.
const HOLD: f32 = 1e4;
/// In sub-steps shorter than this, s, the spring is no stiffer: what is taken back within a shorter time, be it rounding, throws folded strands
/// about.
const AT_ONCE: f32 = 2e-3;
/// What holds an edge against a rotation about itself is never less than this share of all that holds it.
const LEAST_TWIST: f32 = 1e-6;

/// That function: by the displacement of the vertex, by both, and by the rotation.
struct System {
    place: Symmetric,
    mixed: mat3x3<f32>,
    turn: Symmetric,
    force: vec3<f32>,
    torque: vec3<f32>,
    /// What pulls at the vertex, for tension.
    pull: vec3<f32>,
}

/// Of the tip alone, at this place from the root.
fn system_of_tip(strand: Strand, last: Inertia, at: vec3<f32>) -> System {
    var system: System;
    let spring = hold_stiffness(strand);
    let hold = rods[slot(strand, 0u, HOLDING)].xyz;
    let gap = hold_place(strand) - strand.root_now - at;
    system.place = sum(last.mass, scaled_identity(spring));
    system.force = last.force + hold + spring * gap;
    // The force that the tip has come to is held with, not that of the spring, which changes its sign from round to round.
    system.pull = last.force + hold;
    return system;
}

/// The vertex after the edge moves by the one before it and `rotation x arm`: from here on the system is by the displacement of the one before it.
fn move_to_beginning(system: ptr<function, System>, arm: vec3<f32>, axis: vec3<f32>) {
    let by_arm = mixed_by(arm, across((*system).place, axis));
    (*system).turn = sum((*system).turn, with_transpose(cross_columns(arm, (*system).mixed + 0.5 * by_arm)));
    (*system).torque += cross(arm, (*system).force);
    (*system).mixed += by_arm;
}

/// Adds what contacts do to the edge.
@if(contacts)
fn add_push(system: ptr<function, System>, arm: vec3<f32>, push: Push) {
    (*system).turn = sum((*system).turn, turn_by(arm, whole(push.turn)));
    (*system).torque += cross(arm, push.torque);
    (*system).mixed += mixed_by(arm, whole(push.mixed));
    (*system).place = sum((*system).place, push.place);
    (*system).force += push.force;
    (*system).pull += push.pull;
}

/// Takes the edge before a vertex out, behind `move_to_beginning`, and stores what the sweep back needs of it.
fn take_out(system: ptr<function, System>, strand: Strand, vertex: u32, terms: Terms) {
    let axis = terms.axis;
    let length = terms.length;
    // Tension pulls an edge straight; pressure would let it fall, and is left out.
    let correction = strand.mass_correction * length;
    let tension = length * max(dot(axis, (*system).pull), 0.0) - correction * length * length;
    var turn = sum((*system).turn, sum(scaled_identity(tension), outer(-tension, axis)));
    let torque = (*system).torque - terms.inertial;

    let stiff = stiffness_of(terms.spring);
    // Where twist is all but free, f32 would know nothing of what is left of it beside the inertia.
    turn = sum(turn, outer(LEAST_TWIST * trace(sum(turn, stiff)) + terms.against_roll, axis));
    let factors = factors_of(sum(turn, stiff));
    let behind = solved_columns(factors, whole(turn));
    let by_place = solved_columns(factors, transpose((*system).mixed));
    let free = solved(factors, torque + terms.own);
    store_left(strand, vertex, Left(free, behind, scale_of(strand, length) * by_place));

    let before = terms.before;
    (*system).place = sum(sum((*system).place, scaled(-1.0, symmetric_product((*system).mixed, by_place))), before.mass);
    (*system).force += before.force - (*system).mixed * free;
    // Equal to `stiff * free - own`, without the difference of two large numbers.
    (*system).torque = torque_by(terms.spring, solved(factors, torque)) - times(turn, solved(factors, terms.own));
    (*system).mixed = by_spring(transpose(by_place), terms.spring);
    (*system).turn = sum(scaled(0.5, with_transpose(spring_by(terms.spring, behind))), outer(terms.against_roll, terms.direction));
    (*system).pull += before.force;
}

/// The stiffness of the spring that holds a pinned tip; 0 where the tip is free.
fn hold_stiffness(strand: Strand) -> f32 {
    @if(!pinned_tips) { return 0.0; }
    @if(pinned_tips) {
        let share = min(step.length / AT_ONCE, 1.0);
        return HOLD * share * share * strand.tip_mass;
    }
}

/// Where a pinned tip is held.
fn hold_place(strand: Strand) -> vec3<f32> {
    return shape_of(strand.root, rest[strand.edges * step.guides + strand.guide].xyz);
}

/// The columns of a matrix without what they have along an axis. Rotations of an edge about itself do not move its end, and so know nothing
/// of that; but where a pinned tip is all that a straight strand pulls at, its rounding would be more than all that twist is held by.
fn across(m: Symmetric, axis: vec3<f32>) -> mat3x3<f32> {
    let along = times(m, axis);
    let columns = whole(m);
    return mat3x3(columns[0] - along.x * axis, columns[1] - along.y * axis, columns[2] - along.z * axis);
}

/// What a matrix of displacements is as one of displacements by rotations, where these displace by `rotation x arm`;
fn mixed_by(arm: vec3<f32>, m: mat3x3<f32>) -> mat3x3<f32> {
    return transpose(cross_columns(arm, m));
}

/// and as one of rotations.
fn turn_by(arm: vec3<f32>, m: mat3x3<f32>) -> Symmetric {
    return symmetric(cross_columns(arm, mixed_by(arm, m)));
}
