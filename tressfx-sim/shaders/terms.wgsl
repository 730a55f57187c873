// What an edge and the vertex before it bring into a round: their inertia, and the joint before the edge. Nothing of it depends on what the sweep finds of other edges.

import package::joint::{Spring, Stiffness, joint_between, lag_of, spring_of, torque_of};
import package::rod::{LAST_STRAIN, Row, STRAIN, Strand, half_turn, rest, rods, slot};
@if(volume)
import package::rod::push_slot;
import package::root::shape_of;
import package::step::step;
import package::symmetric::{Symmetric, outer, scaled_identity, sum};
import package::vector::direction_or;

/// What holds an edge against rolling about itself is never less than this share of the torque of its joint.
const COUPLED: f32 = 0.1;

/// What an edge brings in.
struct Terms {
    /// The direction of the edge, and that of its parent.
    axis: vec3<f32>,
    length: f32,
    direction: vec3<f32>,
    /// What holds both against rolling about themselves.
    against_roll: f32,
    /// The torque of the joint, and of the inertia between the ends of the edge.
    own: vec3<f32>,
    inertial: vec3<f32>,
    spring: Spring,
    /// Of the vertex before the edge.
    before: Inertia,
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

/// `row` is that of the edge and of the vertex after it, `parent` and `direction` are of the edge before it, whose length is `length_before` (0 at the root); `at` is where the
/// vertex between them is, from the root.
fn terms_of(strand: Strand, vertex: u32, row: Row, axis: vec3<f32>, parent: vec4<f32>, direction: vec3<f32>, length_before: f32, after: Pulled,
            before: Pulled, at: vec3<f32>) -> Terms {
    var terms: Terms;
    let size = row.rest.w;
    terms.axis = axis;
    terms.length = size;
    terms.direction = direction;
    let correction = strand.mass_correction * size;
    terms.inertial = correction * cross(size * axis, after.free - before.free);

    let joined = select(0.0, length_before, vertex > strand.held + 1u);
    let span = max(0.5 * (joined + size), strand.shortest_span);
    let joint = joint_between(parent, half_turn(row.rest), row.now);
    let bending = strand.bending / span * strand.length * strand.length;
    let past = past_strain(strand, vertex, joint.strain);
    let stiffness = Stiffness(bending, step.twist_ratio, lag_of(joint, step.internal_damping / strand.length, past));
    terms.own = torque_of(joint, stiffness, past);
    terms.spring = spring_of(joint, stiffness);
    // The torque of a joint turns with its edges. One that is bent less than it wants holds them against rolling about themselves, which turns its bend out of
    // the plane that it wants; and any couples their rolls with what moves them aside.
    let against_roll = 0.5 * dot(terms.own, cross(direction, axis));
    terms.against_roll = max(against_roll, COUPLED * length(terms.own));

    let mass = 0.5 * (length_before + size);
    let vertex_axis = direction_or(axis + direction, axis);
    terms.before = inertia(strand, vertex - 1u, mass, before, at, vertex_axis);
    return terms;
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
