// The sweep of a round from the root to the tip: turns each edge, and leaves what the next sub-step begins with.

import package::eliminate::{Left, left_of};
import package::joint::{Spring, torque_by, twist_axis};
import package::rod::{
    GUESS, Strand, along, frame_slot, half_turn, moved_slot, positions, rest_before, rods, slot, speed_of,
};
import package::step::step;
import package::symmetric::times;
import package::vector::{after, direction_or, is_finite, turned};
@if(contacts)
import package::rod_touch::{Found, edge_between, look_at, may_touch, nothing_near};

/// The longest rotation of an edge in a round, rad.
const LONGEST_TURN: f32 = 1.5;

/// What the first free edge hangs on.
struct Start {
    moving: vec3<f32>,
    place: vec3<f32>,
    parent: vec4<f32>,
    /// The most that the surface of any capsule has moved.
    @if(contacts) surface: f32,
}

/// What a round has come to.
struct Round {
    /// The longest rotation of an edge, rad.
    longest: f32,
    finite: bool,
    /// What the tip has moved by, and where it is from the root.
    moving: vec3<f32>,
    place: vec3<f32>,
    /// By what the tip is moved where the edges behind the first free one take their guesses.
    aimed: vec3<f32>,
    @if(contacts) found: Found,
}

/// What the sweep needs of a vertex and the edge before it.
struct Hung { left: Left, now: vec4<f32>, frame: vec4<f32>, moved: vec4<f32>, rest: vec4<f32> }

fn hung(strand: Strand, vertex: u32, is_first_round: bool) -> Hung {
    var hung: Hung;
    hung.left = left_of(strand, vertex);
    hung.now = rods[select(frame_slot(strand, vertex, 0u), slot(strand, vertex, GUESS), is_first_round)];
    hung.frame = rods[frame_slot(strand, vertex, 1u)];
    hung.moved = rods[moved_slot(strand, vertex, 1u)];
    hung.rest = rest_before(strand, vertex);
    return hung;
}

/// The guess that Newton's method begins with: the edge is turned, the shortest way, to where its vertices would get with their
/// velocities. `speed` is by what they move beyond each other.
fn aim(now: vec4<f32>, length: f32, speed: vec3<f32>) -> vec4<f32> {
    let here = along(now);
    return turned(now, here, direction_or(length * here + speed, here));
}

/// `limit`: an edge that turns by more, rad, makes another round certain; then what the round comes to is not kept, but for the frames.
fn substitute(strand: Strand, start: Start, is_first_round: bool, limit: f32) -> Round {
    let speed = speed_of(strand.has_past, 1.0);
    var round: Round;
    round.finite = true;
    round.moving = start.moving;
    round.place = start.place;
    var shift = vec3(0.0);
    var parent_turn = vec3(0.0);
    var parent = start.parent;
    var speed_before = vec3(0.0);
    @if(contacts) var found = Found(nothing_near(), false, false);
    @if(contacts) var clear = 0.0;
    for (var vertex = strand.held + 1u; vertex <= strand.edges; vertex++) {
        let here = hung(strand, vertex, is_first_round);
        let length = here.rest.w;
        let spring = Spring(here.left.bending, step.twist_ratio, twist_axis(after(parent, half_turn(here.rest))));
        let torque = torque_by(spring, parent_turn) - shift * here.left.mixed;
        var turn = here.left.free + times(here.left.inverse, torque);
        let size = sqrt(dot(turn, turn));
        turn *= min(1.0, LONGEST_TURN / max(size, LONGEST_TURN));
        round.longest = max(round.longest, min(size, LONGEST_TURN));
        let now = normalize(after(rotation_by(turn), here.now));
        let axis = along(now);
        let moving_before = round.moving;
        let place_before = round.place;
        shift += length * cross(turn, along(here.now));
        round.moving += length * (axis - along(here.frame));
        round.place += length * axis;
        round.finite = round.finite && is_finite(round.place) && is_finite(round.moving);
        rods[frame_slot(strand, vertex, 0u)] = now;
        @if(contacts) {
            let edge = edge_between(strand, place_before, round.place, moving_before, round.moving);
            if (may_touch(&clear, start.surface, strand, edge, length)) { look_at(&found, strand, edge, vertex); }
        }
        if (round.longest <= limit) {
            rods[moved_slot(strand, vertex, 0u)] = vec4(round.moving, here.moved.w);
            positions[vertex * step.strands + strand.guide] = vec4(strand.root_now + round.place, here.moved.w);
            // By what the vertex would move in another sub-step.
            let speed_here = speed.x * round.moving + speed.y * here.moved.xyz;
            if (vertex > strand.held + 1u) {
                let guess = aim(now, length, speed_here - speed_before);
                round.aimed += length * (along(guess) - axis);
                rods[slot(strand, vertex, GUESS)] = guess;
            }
            speed_before = speed_here;
        }
        parent = here.now;
        parent_turn = turn;
    }
    @if(contacts) {
        round.found = found;
    }
    return round;
}

/// Takes the guesses once more, with velocities of first order, where a strand was too fast for the others.
fn aim_again(strand: Strand) -> vec3<f32> {
    var aimed = vec3(0.0);
    var before = rods[moved_slot(strand, strand.held + 1u, 0u)].xyz;
    for (var vertex = strand.held + 2u; vertex <= strand.edges; vertex++) {
        let moved = rods[moved_slot(strand, vertex, 0u)].xyz;
        let now = rods[frame_slot(strand, vertex, 0u)];
        let length = rest_before(strand, vertex).w;
        let guess = aim(now, length, moved - before);
        aimed += length * (along(guess) - along(now));
        rods[slot(strand, vertex, GUESS)] = guess;
        before = moved;
    }
    return aimed;
}

/// The rotation by an angle about an axis, given as their product.
fn rotation_by(v: vec3<f32>) -> vec4<f32> {
    let angle = sqrt(dot(v, v));
    // sin(x / 2) / x and its limit.
    let share = select(0.5, sin(0.5 * angle) / angle, angle > 1e-3);
    return vec4(share * v, cos(0.5 * angle));
}
