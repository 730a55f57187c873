// The sweep of a round from the root to the tip: turns each edge, and leaves what the next sub-step begins with.

import package::left::{Packed, left_of, packed_left, scale_of};
import package::rod::{
    AIMED, FRAME, GUESS, Strand, TURNED, along, moved_slot, positions, rest, rest_before, rods, slot, speed_of,
};
import package::step::step;
import package::vector::{after, is_finite, turned_by};
@if(colliders)
import package::rod_near::{Range, near_obstacles, no_edge, nothing_known, squared_past_head};

/// An edge whose ends move against each other by more than so many times its length is not aimed: it could point anywhere.
const NO_AIM: f32 = 2.0;
/// Nor is one that would be turned by more than what this cosine says,
const FOLDED: f32 = -0.99;
/// nor is one rolled that has rolled by more than this, rad.
const MOST_ROLL: f32 = 0.5;
/// The limit of the last of a strand's rounds: whatever it comes to, there is no other.
const NO_LIMIT: f32 = 1e9;

/// What the first free edge hangs on.
struct Start {
    moving: vec3<f32>,
    place: vec3<f32>,
    parent: vec4<f32>,
    /// The most that the surface of any collider has moved past the head.
    @if(colliders) surface: f32,
}

/// What a round has come to.
struct Round {
    /// Rounds that are done.
    count: u32,
    /// The longest rotation of an edge, rad.
    longest: f32,
    finite: bool,
    /// What the tip has moved by, and where it is from the root.
    moving: vec3<f32>,
    place: vec3<f32>,
    /// By what the tip is moved past the root where the edges take their guesses.
    aimed: vec3<f32>,
    /// Whether anything was touched in its sweep from the tip.
    @if(contacts) touching: bool,
    /// The edges that may touch something.
    @if(colliders) near: Range,
}

/// A round at its beginning.
fn nothing_done(start: Start) -> Round {
    var round: Round;
    round.finite = true;
    round.moving = start.moving;
    round.place = start.place;
    @if(colliders) {
        round.near = no_edge();
    }
    return round;
}

/// What the sweep needs of a vertex and the edge before it.
struct Hung {
    left: Packed,
    now: vec4<f32>,
    /// With the length, whose sign says whether the edge came back in the last sub-step.
    by: vec4<f32>,
    /// With the roll of the edge so far; the guess has that of the sub-step before.
    moved: vec4<f32>,
}

fn hung(strand: Strand, vertex: u32, is_first_round: bool) -> Hung {
    var hung: Hung;
    hung.left = packed_left(strand, vertex);
    hung.now = rods[slot(strand, vertex, select(FRAME, GUESS, is_first_round))];
    hung.by = rods[slot(strand, vertex, select(TURNED, AIMED, is_first_round))];
    hung.moved = rods[moved_slot(strand, vertex, 1u)];
    return hung;
}

/// The inverse mass of a vertex. The solver asks only whether it is 0; where positions go, it goes with them.
fn inverse_mass(strand: Strand, vertex: u32) -> f32 {
    @if(!inverse_masses) {
        if (vertex > strand.held) { return 1.0; }
    }
    return rest[vertex * step.guides + strand.guide].w;
}

/// A frame, and what the direction changes by on the way to it.
struct Aimed { frame: vec4<f32>, by: vec3<f32> }

/// The guess that Newton's method begins with: the edge is turned, the shortest way, to where its vertices would get with their
/// velocities; by these its end would get `apart` from its beginning. And it rolls on about itself.
fn aim(frame: vec4<f32>, roll: f32, length: f32, apart: vec3<f32>) -> Aimed {
    let here = along(frame);
    let there = length * here + apart;
    let size = sqrt(dot(there, there));
    let is_wild = dot(apart, apart) >= NO_AIM * NO_AIM * length * length;
    if (is_wild || dot(here, there) <= FOLDED * size) { return Aimed(rolled(frame, roll), vec3(0.0)); }
    // By how much the distance of the ends grows; from their difference it would be rounding.
    let stretch = dot(apart, length * here + there) / (length + size);
    let by = (apart - stretch * here) / size;
    return Aimed(rolled(after(vec4(cross(here, by), 2.0 + dot(here, by)), frame), roll), by);
}

/// A frame that is rolled about its own edge by an angle, or by a little less: by `roll - roll^3 / 12`. It need not have the length 1.
fn rolled(frame: vec4<f32>, roll: f32) -> vec4<f32> {
    let half = 0.5 * roll;
    return normalize(frame + half * vec4(frame.y, -frame.x, frame.w, -frame.z));
}

/// Stores a guess, and whether the edge came back in the sub-step before it; gives by what it moves the end of the edge.
fn keep_aim(strand: Strand, vertex: u32, length: f32, came_back: bool, aimed: Aimed) -> vec3<f32> {
    rods[slot(strand, vertex, GUESS)] = aimed.frame;
    rods[slot(strand, vertex, AIMED)] = vec4(aimed.by, select(length, -length, came_back));
    return length * aimed.by;
}

/// Where no other round follows one of this limit, whatever it comes to, and nothing else asks for frames, only the guesses are kept.
fn needs_frames(limit: f32) -> bool {
    @if(colliders || internal_damping) { return true; }
    @if(!colliders && !internal_damping) { return limit < NO_LIMIT; }
}

/// What a sweep to the tip carries from edge to edge: by what the vertex before the next edge is moved, the rotation of its parent, and the longest so far, rad.
struct Carried { shift: vec3<f32>, turn: vec3<f32>, longest: f32 }

/// Finds the rotation of an edge of this direction; none is longer than `most`, rad.
fn turn_next(carried: ptr<function, Carried>, strand: Strand, packed: Packed, length: f32, direction: vec3<f32>, most: f32) {
    let left = left_of(packed);
    let parent_turn = (*carried).turn;
    let scaled = (*carried).shift / scale_of(strand, length);
    var turn = left.free + parent_turn - left.behind * parent_turn - left.by_place * scaled;
    let size = sqrt(dot(turn, turn));
    turn *= min(1.0, most / max(size, most));
    (*carried).longest = max((*carried).longest, min(size, most));
    (*carried).shift += length * cross(turn, direction);
    (*carried).turn = turn;
}

/// An edge that is turned: its frame, what its direction has changed by in this sub-step, and its roll so far.
struct Turned { now: vec4<f32>, by: vec3<f32>, roll: f32 }

fn turned(here: Hung, turn: vec3<f32>) -> Turned {
    let direction = along(here.now);
    let rotation = rotation_by(turn);
    let by = here.by.xyz + turned_by(rotation, direction);
    return Turned(normalize(after(rotation, here.now)), by, here.moved.w + dot(turn, direction));
}

/// Keeps it for the next round.
fn keep_turned(strand: Strand, vertex: u32, here: Hung, turned: Turned) {
    rods[slot(strand, vertex, FRAME)] = turned.now;
    rods[slot(strand, vertex, TURNED)] = vec4(turned.by, here.by.w);
    rods[moved_slot(strand, vertex, 1u)] = vec4(here.moved.xyz, turned.roll);
}

/// Keeps what the next sub-step begins with, should no other round follow: where the vertex is from the root and what it has moved by, and the guess, by `apart`
/// between the ends of the edge. Where edges `may_stay`, one that comes back twice in a row is guessed to stay where it is. Gives by what the guess moves
/// the end of the edge.
fn keep_place(strand: Strand, vertex: u32, here: Hung, turned: Turned, place: vec3<f32>, moving: vec3<f32>, apart: vec3<f32>, swings_back: bool,
              may_stay: bool) -> vec3<f32> {
    let roll = select(turned.roll, 0.0, abs(turned.roll) > MOST_ROLL);
    rods[moved_slot(strand, vertex, 0u)] = vec4(moving, roll);
    positions[vertex * step.strands + strand.guide] = vec4(strand.root_now + place, inverse_mass(strand, vertex));
    // A round may go too far, and where the guess goes on the same way, the next round goes back as far: so the guess stays.
    let came_back = here.by.w < 0.0;
    let goes_on = select(apart, vec3(0.0), may_stay && came_back && swings_back);
    let length = abs(here.by.w);
    return keep_aim(strand, vertex, length, swings_back, aim(turned.now, roll, length, goes_on));
}

/// No edge turns by more than `most`, rad. An edge that turns by more than `limit` makes another round certain; then what the round comes to is
/// not kept, but for the frames and rolls. For `may_stay` see `keep_place`.
fn substitute(strand: Strand, start: Start, is_first_round: bool, most: f32, limit: f32, may_stay: bool) -> Round {
    var round = nothing_done(start);
    var carried: Carried;
    let speed = speed_of(strand.has_past, 1.0);
    var moved_before = rods[moved_slot(strand, strand.held, 1u)].xyz;
    var speed_before = speed.x * start.moving + speed.y * moved_before;
    @if(colliders) var near = round.near;
    @if(colliders) var clear = nothing_known();
    @if(colliders) var past_before = squared_past_head(strand, start.place, start.moving);
    var next = hung(strand, strand.held + 1u, is_first_round);
    for (var vertex = strand.held + 1u; vertex <= strand.edges; vertex++) {
        let here = next;
        next = hung(strand, min(vertex + 1u, strand.edges), is_first_round);
        let length = abs(here.by.w);
        turn_next(&carried, strand, here.left, length, along(here.now), most);
        let turned = turned(here, carried.turn);
        @if(colliders) let place_before = round.place;
        round.moving += length * turned.by;
        round.place += length * along(turned.now);
        if (needs_frames(limit)) { keep_turned(strand, vertex, here, turned); }
        @if(colliders) {
            let past = squared_past_head(strand, round.place, round.moving);
            let more = max(past_before, past);
            let obstacles = near_obstacles(&clear, start.surface, more, strand, place_before, round.place, length);
            if (obstacles != 0u) { near = Range(min(near.first, vertex), vertex); }
            past_before = past;
        }
        if (carried.longest <= limit) {
            // By what the vertex would move in another sub-step of this length.
            let speed_here = speed.x * round.moving + speed.y * here.moved.xyz;
            let swings_back = dot(turned.by, here.moved.xyz - moved_before) < 0.0;
            let apart = speed_here - speed_before;
            speed_before = speed_here;
            round.aimed += keep_place(strand, vertex, here, turned, round.place, round.moving, apart, swings_back, may_stay);
            moved_before = here.moved.xyz;
        }
    }
    @if(colliders) {
        round.near = near;
    }
    round.longest = carried.longest;
    round.finite = is_finite(round.place) && is_finite(round.moving);
    return round;
}

/// Takes the guesses once more, with velocities of first order, where a strand was too fast for the others. Of what its vertices moved by past
/// what holds them only the share `kept` counts as velocity.
fn aim_again(strand: Strand, kept: f32) -> vec3<f32> {
    var aimed = vec3(0.0);
    let held = rods[moved_slot(strand, strand.held, 0u)].xyz;
    var before = held;
    for (var vertex = strand.held + 1u; vertex <= strand.edges; vertex++) {
        let moved = rods[moved_slot(strand, vertex, 0u)];
        aimed += aim_edge_again(strand, vertex, moved, before, held, kept);
        before = moved.xyz;
    }
    return aimed;
}

/// The same of an edge whose ends moved by so much.
fn aim_edge_again(strand: Strand, vertex: u32, moved: vec4<f32>, moved_before: vec3<f32>, held: vec3<f32>, kept: f32) -> vec3<f32> {
    let slower = mix(held, moved.xyz, kept);
    rods[moved_slot(strand, vertex, 0u)] = vec4(slower, moved.w);
    let length = rods[slot(strand, vertex, AIMED)].w;
    let frame = frame_before_aim(strand, vertex, moved.w);
    let guess = aim(frame, moved.w, abs(length), slower - mix(held, moved_before, kept));
    return keep_aim(strand, vertex, abs(length), length < 0.0, guess);
}

/// The frame that a guess was made from, with this roll.
fn frame_before_aim(strand: Strand, vertex: u32, roll: f32) -> vec4<f32> {
    let guess = rolled(rods[slot(strand, vertex, GUESS)], -roll);
    let by = rods[slot(strand, vertex, AIMED)].xyz;
    let here = along(guess) - by;
    return normalize(after(vec4(-cross(here, by), 2.0 + dot(here, by)), guess));
}

/// The rotation by an angle about an axis, given as their product.
fn rotation_by(v: vec3<f32>) -> vec4<f32> {
    let angle = sqrt(dot(v, v));
    // sin(x / 2) / x and its limit.
    let share = select(0.5, sin(0.5 * angle) / angle, angle > 1e-3);
    return vec4(share * v, cos(0.5 * angle));
}
