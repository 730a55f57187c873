// The sweep of a round from the tip to the root: takes each edge out of the system, and gives the vertex before it and its parent what
// the edge and all beyond want of them. That is half of a quadratic function of the displacement of a vertex and of the rotation of
// the edge before it.

import package::joint::{Stiffness, by_spring, joint_between, lag_of, spring_by, spring_of, stiffness_of, torque_by, torque_of};
import package::left::{Left, scale_of, store_left};
import package::rod::{
    HOLDING, LAST_STRAIN, Row, STRAIN, Strand, along, half_turn, rest, rods, row_of, slot,
};
import package::root::shape_of;
import package::step::step;
import package::symmetric::{
    Symmetric, cross_columns, factors_of, outer, scaled, scaled_identity, solved, solved_columns, sum, symmetric, symmetric_product,
    times, trace, whole, with_transpose,
};
import package::vector::direction_or;
@if(volume)
import package::rod::push_slot;
@if(contacts)
import package::rod_contact::contacts_of;
@if(colliders)
import package::rod_near::{Range, is_in, near_obstacles, nothing_known, squared_past_head};
import package::rod_touch::Found;
@if(contacts)
import package::rod_touch::{edge_between, last_touch};

/// How stiff the spring is that holds a pinned tip, over the mass that hangs on it.
const HOLD: f32 = 1e4;
/// In sub-steps shorter than this, s, the spring is no stiffer: what is taken back within a shorter time, be it rounding, throws folded strands
/// about.
const AT_ONCE: f32 = 2e-3;
/// What holds an edge against a rotation about itself is never less than this share of all that holds it.
const LEAST_TWIST: f32 = 1e-6;

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

/// A vertex: where the past says that it would be without forces, and with gravity alone, from where it is.
struct Pulled { place: vec3<f32>, free: vec3<f32> }

fn pulled(strand: Strand, vertex: u32, row: Row, moving: vec3<f32>) -> Pulled {
    let carry = strand.carry.x * row.moved + strand.carry.y * row.moved_before + strand.carry.z * row.moved_earlier;
    var free = carry - moving + strand.fall;
    @if(volume) {
        free += strand.length * strand.length * rods[push_slot(strand.guide, vertex)].xyz;
    }
    return Pulled(strand.past * row.moved - moving, free);
}

/// The mass of a vertex with what acts on it in proportion to its place, and the force.
struct Inertia { mass: Symmetric, force: vec3<f32> }

/// `place` is from the root.
fn inertia(strand: Strand, vertex: u32, mass: f32, pulled: Pulled, place: vec3<f32>, axis: vec3<f32>) -> Inertia {
    let across = strand.length * step.drag_across;
    let along = strand.length * step.drag_along - across;
    let blown = pulled.place + strand.length * strand.wind;
    var force = pulled.free + across * blown + along * dot(axis, blown) * axis;
    var held = 1.0 + across;
    @if(pull) {
        let pull = strand.length * strand.length * step.pull;
        let goal = shape_of(strand.root, rest[vertex * step.guides + strand.guide].xyz);
        force += pull * (goal - strand.root_now - place);
        held += pull;
    }
    return Inertia(sum(scaled_identity(mass * held), outer(mass * along, axis)), mass * force);
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
    let last = inertia(strand, tip, 0.5 * row.rest.w, after_edge, at, axis);
    let spring = hold_stiffness(strand);
    let hold = rods[slot(strand, 0u, HOLDING)].xyz;
    let gap = hold_place(strand) - strand.root_now - at;
    var place = sum(last.mass, scaled_identity(spring));
    var mixed = mat3x3<f32>();
    var turn = scaled_identity(0.0);
    var force = last.force + hold + spring * gap;
    var torque = vec3(0.0);
    // The force that the tip has come to is held with, not that of the spring, which changes its sign from round to round.
    var pull = last.force + hold;
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

        // The vertex after the edge moves by the one before it and `rotation x arm`.
        let arm = length * axis;
        let by_arm = mixed_by(arm, across(place, axis));
        turn = sum(turn, with_transpose(cross_columns(arm, mixed + 0.5 * by_arm)));
        torque += cross(arm, force);
        mixed += by_arm;
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
                        turn = sum(turn, turn_by(arm, whole(contacts.turn)));
                        torque += cross(arm, contacts.torque);
                        mixed += mixed_by(arm, whole(contacts.mixed));
                        place = sum(place, contacts.place);
                        force += contacts.force;
                        pull += contacts.pull;
                        found.near = true;
                        found.touching = found.touching || contacts.touch.obstacle > 0u;
                        found.deep = found.deep || contacts.touch.is_deep;
                    }
                }
            }
        }
        length_after = length;
        // Tension pulls an edge straight; pressure would let it fall, and is left out.
        let correction = strand.mass_correction * length;
        let tension = length * max(dot(axis, pull), 0.0) - correction * length * length;
        turn = sum(turn, sum(scaled_identity(tension), outer(-tension, axis)));
        torque -= correction * cross(arm, after_edge.free - before_edge.free);

        let joined = select(0.0, length_before, vertex > strand.held + 1u);
        let span = max(0.5 * (joined + length), strand.shortest_span);
        let joint = joint_between(parent, half_turn(row.rest), row.now);
        let bending = strand.bending / span * strand.length * strand.length;
        let past = past_strain(strand, vertex, joint.strain);
        let stiffness = Stiffness(bending, step.twist_ratio, lag_of(joint, step.internal_damping / strand.length, past));
        let own = torque_of(joint, stiffness, past);
        let spring = spring_of(joint, stiffness);
        let stiff = stiffness_of(spring);

        // Where twist is all but free, f32 would know nothing of what is left of it beside the inertia.
        turn = sum(turn, outer(LEAST_TWIST * trace(sum(turn, stiff)), axis));
        // A joint that is bent less than it wants holds its edges against rolling about themselves, which turns its bend out of the plane that it wants.
        let against_roll = 0.5 * max(dot(own, cross(direction, axis)), 0.0);
        turn = sum(turn, outer(against_roll, axis));
        let factors = factors_of(sum(turn, stiff));
        let behind = solved_columns(factors, whole(turn));
        let by_place = solved_columns(factors, transpose(mixed));
        let free = solved(factors, torque + own);
        store_left(strand, vertex, Left(free, behind, scale_of(strand, length) * by_place));

        let mass = 0.5 * (length_before + length);
        let vertex_axis = direction_or(axis + direction, axis);
        let before = inertia(strand, vertex - 1u, mass, before_edge, at, vertex_axis);
        place = sum(sum(place, scaled(-1.0, symmetric_product(mixed, by_place))), before.mass);
        force += before.force - mixed * free;
        // Equal to `stiff * free - own`, without the difference of two large numbers.
        torque = torque_by(spring, solved(factors, torque)) - times(turn, solved(factors, own));
        mixed = by_spring(transpose(by_place), spring);
        turn = sum(scaled(0.5, with_transpose(spring_by(spring, behind))), outer(against_roll, direction));
        pull += before.force;

        after_edge = before_edge;
        axis = direction;
        row = next;
        // Not earlier: that takes registers that there are not.
        next = row_of(strand, max(vertex, 2u) - 2u, begin.is_first_round);
    }
    return found;
}

/// What the past says of a strain.
fn past_strain(strand: Strand, vertex: u32, strain: vec3<f32>) -> vec3<f32> {
    @if(!internal_damping) { return strain; }
    @if(internal_damping) {
        let last = rods[slot(strand, vertex, STRAIN)].xyz;
        let before = rods[slot(strand, vertex, LAST_STRAIN)].xyz;
        return select(last, (4.0 * last - before) / 3.0, strand.has_past);
    }
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
