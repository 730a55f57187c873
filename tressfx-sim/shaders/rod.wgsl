// The rods of a section in buffers: their rest, their state, and what the sweeps of a sub-step leave for each other.

import package::grid::GROUP;
import package::root::{Root, root_of, shape_of};
import package::step::step;
import package::vector::{after, rotate};
import package::wind::wind_of;

@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
/// Two for each vertex: half of the rotation that the joint before the edge to the next one wants, the fourth component of which
/// follows from the others and gives way to the length of the edge; and the frame of that edge at rest. The tip has no such edge; its first
/// has what the strand's bending is multiplied by, how many edges the root holds, the shortest length that bends, and the mass
/// that hangs on a pinned tip (0 on a free one), its second the length of the strand.
@group(0) @binding(2) var<storage, read> rod_rest: array<vec4<f32>>;
/// `SLOTS` for each vertex: what belongs to it and to the edge before it. The strands of a group are beside each other.
@group(0) @binding(3) var<storage, read_write> rods: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> positions: array<vec4<f32>>;

const SLOTS: u32 = 14u;
/// How many of them lie beside each other in memory. Strands that touch something are read alone, and a GPU reads no less than two.
@if(colliders)
const ADJACENT: u32 = 2u;
@if(!colliders)
const ADJACENT: u32 = 1u;
/// What the vertex moved by in each of the last sub-steps, in turns, and by how much its edge rolled about itself, rad: in the last one by
/// how much it rolls in the guess, and then so far.
const MOVED: u32 = 0u;
const MOVES: u32 = 4u;
/// The frame of the edge; and what its direction has changed by in this sub-step, with its length. Not where no other round follows, unless something else
/// asks for them.
const FRAME: u32 = 4u;
const TURNED: u32 = 5u;
/// The frame that the next sub-step begins with; and what the direction changes by with it, with the length, below 0 where the edge came back; see `aim`.
const GUESS: u32 = 6u;
const AIMED: u32 = 7u;
/// What the elimination leaves of the edge, three of them: see `Left`.
const LEFT: u32 = 8u;
/// The strain of the joint before the edge and what the edge touches, and the strain before.
const STRAIN: u32 = 11u;
const LAST_STRAIN: u32 = 12u;
/// How far the friction of the edge is stretched, and the side that it touches.
const TOUCH: u32 = 13u;

/// The root has no edge before it. Its slots of edges are those of the strand: by what the tip is moved past the root where the
/// edges take their guesses, and `Marks`;
const BEGIN: u32 = GUESS;
/// the lengths of the last two sub-steps, and the first and the last vertex behind an edge that was near a collider;
const LENGTHS: u32 = TOUCH;
/// the force that holds a pinned tip.
const HOLDING: u32 = LEFT;
/// Others of its slots are a list of the strands that `direct` has left to `direct_near`, the first one in those of the first strand: its guide,
/// how many rounds it has done, and its range of edges that may touch something;
const LISTED: u32 = 9u;
/// what the tip is moved by where edges take their guesses, and the longest rotation of an edge in the last of these rounds.
const SO_FAR: u32 = 10u;

/// What is the same for a whole strand.
struct Strand {
    guide: u32,
    /// Where its slots are.
    base: u32,
    /// Which of the turns this sub-step has.
    turn: u32,
    root: Root,
    /// Where the root is, relative to the centre of the groom, and by what it has moved.
    root_now: vec3<f32>,
    root_moved: vec3<f32>,
    /// Edges that the root holds.
    held: u32,
    edges: u32,
    bending: f32,
    shortest_span: f32,
    mass_correction: f32,
    wind: vec3<f32>,
    /// The mass that hangs on a pinned tip; 0 on a free one.
    tip_mass: f32,
    /// Whether the past counts: not after a reset, after a change of the sub-step, or after an edge turned too fast; and whether it
    /// did one sub-step ago.
    has_past: bool,
    had_past: bool,
    /// The length that the formula in time divides by.
    length: f32,
    /// What gravity makes of the sub-step.
    fall: vec3<f32>,
    /// What the last three displacements of a vertex are multiplied by to give where the past says that it would be without forces.
    carry: vec3<f32>,
    /// What the last one is multiplied by: the part of that which is no velocity.
    past: f32,
}

/// How a strand came out of the last sub-step.
struct Marks { turn: u32, counts: bool, had_past: bool, had_past_before: bool }

fn unpacked_marks(packed: f32) -> Marks {
    let bits = u32(packed);
    return Marks(bits & 3u, (bits & 4u) != 0u, (bits & 8u) != 0u, (bits & 16u) != 0u);
}

fn packed_marks(marks: Marks) -> f32 {
    let flags = select(0u, 4u, marks.counts) | select(0u, 8u, marks.had_past) | select(0u, 16u, marks.had_past_before);
    return f32(marks.turn | flags);
}

/// The displacement by the velocity in a sub-step, of the last two displacements: by the formula of second order, or of first.
fn speed_of(second_order: bool, ratio: f32) -> vec2<f32> {
    return ratio * select(vec2(1.0, 0.0), vec2(1.5, -0.5), second_order);
}

fn strand_of(guide: u32) -> Strand {
    let tip = rod_rest[2u * (step.vertices - 1u) * step.guides + guide];
    let base = base_of(guide);
    let marks = unpacked_marks(rods[slot_of(guide, 0u, BEGIN)].w);
    let lengths = rods[slot_of(guide, 0u, LENGTHS)].xy;
    let ratios = select(step.length / lengths, vec2(1.0), lengths == vec2(0.0));
    let has_past = step.first_order == 0u && marks.counts;
    let now = speed_of(marks.had_past, ratios.x);
    let before = speed_of(marks.had_past_before, ratios.y);
    var strand: Strand;
    strand.guide = guide;
    strand.base = base;
    strand.turn = (marks.turn + 1u) % MOVES;
    strand.root = root_of(guide);
    strand.root_now = shape_of(strand.root, rest[guide].xyz);
    strand.root_moved = strand.root_now - positions[guide].xyz + step.center_displacement;
    strand.held = u32(tip.y);
    strand.edges = step.vertices - 1u;
    strand.bending = step.bending * tip.x;
    strand.shortest_span = tip.z;
    strand.mass_correction = select(5.0 / 6.0, 1.0, step.vertices == 2u) / 6.0;
    strand.wind = wind_of(guide);
    strand.has_past = has_past;
    strand.had_past = marks.had_past;
    strand.tip_mass = tip.w;
    strand.length = select(step.length, step.length * (2.0 / 3.0), has_past);
    strand.fall = step.gravity * select(1.0, 4.0 / 9.0, has_past);
    strand.past = select(0.0, 1.0 / 3.0, has_past);
    // Of BDF2: two thirds of (4 times the last displacement by the velocity - that before) / 3.
    let second = vec3(8.0 * now, 0.0) - vec3(0.0, 2.0 * before);
    strand.carry = select(vec3(now, 0.0), second / 9.0 + vec3(1.0 / 3.0, 0.0, 0.0), has_past);
    return strand;
}

fn slot(strand: Strand, vertex: u32, slot: u32) -> u32 {
    return strand.base + slot_in_group(vertex, slot);
}

/// Where the slots of a guide are.
fn base_of(guide: u32) -> u32 {
    return guide / GROUP * step.vertices * SLOTS * GROUP + guide % GROUP * ADJACENT;
}

fn slot_in_group(vertex: u32, slot: u32) -> u32 {
    let place = vertex * SLOTS + slot;
    return (place - place % ADJACENT) * GROUP + place % ADJACENT;
}

/// The same as `slot` where nothing else of the strand is asked for.
fn slot_of(guide: u32, vertex: u32, slot: u32) -> u32 {
    return base_of(guide) + slot_in_group(vertex, slot);
}

/// The acceleration by the hair around a vertex; behind all slots, and only where hair meets hair.
fn push_slot(guide: u32, vertex: u32) -> u32 {
    let groups = (step.guides + GROUP - 1u) / GROUP;
    return groups * GROUP * step.vertices * SLOTS + vertex * step.guides + guide;
}

/// What a vertex moved by so many sub-steps ago; 0 is this one.
fn moved_slot(strand: Strand, vertex: u32, ago: u32) -> u32 {
    return slot(strand, vertex, MOVED + (strand.turn + MOVES - ago) % MOVES);
}

/// The half turn and the length of the edge before a vertex.
fn rest_before(strand: Strand, vertex: u32) -> vec4<f32> {
    return rod_rest[2u * (vertex - 1u) * step.guides + strand.guide];
}

fn half_turn(packed: vec4<f32>) -> vec4<f32> {
    return vec4(packed.xyz, sqrt(1.0 - dot(packed.xyz, packed.xyz)));
}

/// Of the edge before a vertex.
fn frame_at_rest(strand: Strand, vertex: u32) -> vec4<f32> {
    return after(strand.root.rotation, rod_rest[(2u * vertex - 1u) * step.guides + strand.guide]);
}

/// The length of the whole strand.
fn reach_of(strand: Strand) -> f32 {
    return rod_rest[(2u * strand.edges + 1u) * step.guides + strand.guide].x;
}

fn along(frame: vec4<f32>) -> vec3<f32> {
    return rotate(frame, vec3(0.0, 0.0, 1.0));
}

/// A vertex and the edge before it, at the beginning of a round.
struct Row {
    /// What the vertex moved by one, two and three sub-steps ago.
    moved: vec3<f32>,
    moved_before: vec3<f32>,
    moved_earlier: vec3<f32>,
    /// The frame as far as it is known, and what the direction has changed by. From the frames before and after a short sub-step that
    /// would be rounding, and a strand would get its speed from it.
    now: vec4<f32>,
    by: vec3<f32>,
    /// Half turn and length.
    rest: vec4<f32>,
}

/// The row of a vertex; of the root, what it moved by alone. The first round begins with the guess.
fn row_of(strand: Strand, vertex: u32, is_first_round: bool) -> Row {
    var row: Row;
    row.moved = rods[moved_slot(strand, vertex, 1u)].xyz;
    row.moved_before = rods[moved_slot(strand, vertex, 2u)].xyz;
    row.moved_earlier = rods[moved_slot(strand, vertex, 3u)].xyz;
    row.now = rods[slot(strand, vertex, select(FRAME, GUESS, is_first_round))];
    row.by = rods[slot(strand, vertex, select(TURNED, AIMED, is_first_round))].xyz;
    row.rest = rest_before(strand, max(vertex, 1u));
    return row;
}
