// The rods of a section in buffers: their rest, their state, and what the sweeps of a sub-step leave for each other.

import package::root::{Root, root_of, shape_of};
import package::step::step;
import package::vector::{after, rotate};
import package::wind::wind_of;
@if(contacts)
import package::rod_contact::{Edge, Touch, nothing_touched, unpacked_direction};

@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
/// Two for each vertex: half of the rotation that the joint before its edge wants, the fourth component of which follows from the
/// others and gives way to the length of the edge; and the frame of the edge at rest. The tip has no edge; its first has what the strand's
/// bending is multiplied by, how many edges the root holds, the shortest length that bends, and 1 if the tip is pinned.
@group(0) @binding(2) var<storage, read> rod_rest: array<vec4<f32>>;
/// `SLOTS` for each vertex: the state, and from `NOW` on what the sweeps leave for each other.
@group(0) @binding(3) var<storage, read_write> rods: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> positions: array<vec4<f32>>;

const SLOTS: u32 = 14u;
/// The frame of the edge, at the tip the force that holds it; what the vertex moved by in the last sub-step; its velocity, and at the root
/// whether the past counts; its velocity before; the strain of the joint, and before. The fourth components of the others have what the edge
/// before the vertex touches: how far friction is stretched, the side that it is on, and the capsule.
const FRAME: u32 = 0u;
const MOVED: u32 = 1u;
const VELOCITY: u32 = 2u;
const LAST_VELOCITY: u32 = 3u;
const STRAIN: u32 = 4u;
const LAST_STRAIN: u32 = 5u;
/// The frame of the edge and what the vertex has moved by in this sub-step, as far as they are known; what is left of the edge
/// after the elimination: by the columns of two matrices what of its rotation its parent's rotation and the displacement of the vertex before
/// it make, and in the fourth components of the first its rotation without them.
const NOW: u32 = 6u;
const MOVING: u32 = 7u;
const BY_PARENT: u32 = 8u;
const BY_PLACE: u32 = 11u;

/// What is the same for a whole strand.
struct Strand {
    guide: u32,
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
    /// 1 where the tip is pinned.
    tip_pinned: f32,
    has_past: bool,
    /// The length that the formula in time divides by.
    length: f32,
    /// What gravity makes of the sub-step.
    fall: vec3<f32>,
}

fn strand_of(guide: u32) -> Strand {
    let tip = rod_rest[2u * (step.vertices - 1u) * step.guides + guide];
    let has_past = step.first_order == 0u && rods[VELOCITY * step.guides + guide].w > 0.5;
    var strand: Strand;
    strand.guide = guide;
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
    strand.tip_pinned = tip.w;
    strand.length = select(step.length, step.length * (2.0 / 3.0), has_past);
    strand.fall = step.gravity * select(1.0, 4.0 / 9.0, has_past);
    return strand;
}

fn slot(strand: Strand, vertex: u32, slot: u32) -> u32 {
    return (vertex * SLOTS + slot) * step.guides + strand.guide;
}

fn length_of(strand: Strand, edge: u32) -> f32 {
    return rod_rest[2u * edge * step.guides + strand.guide].w;
}

fn half_turn(strand: Strand, edge: u32) -> vec4<f32> {
    let v = rod_rest[2u * edge * step.guides + strand.guide].xyz;
    return vec4(v, sqrt(1.0 - dot(v, v)));
}

fn frame_at_rest(strand: Strand, edge: u32) -> vec4<f32> {
    return after(strand.root.rotation, rod_rest[(2u * edge + 1u) * step.guides + strand.guide]);
}

fn along(frame: vec4<f32>) -> vec3<f32> {
    return rotate(frame, vec3(0.0, 0.0, 1.0));
}

/// What an edge touched at the end of the last sub-step.
@if(contacts)
fn last_touch(strand: Strand, edge: u32) -> Touch {
    let vertex = edge + 1u;
    let obstacle = u32(rods[slot(strand, vertex, LAST_STRAIN)].w);
    var touch = nothing_touched();
    if (obstacle > 0u) {
        let x = rods[slot(strand, vertex, MOVED)].w;
        let y = rods[slot(strand, vertex, VELOCITY)].w;
        let z = rods[slot(strand, vertex, LAST_VELOCITY)].w;
        touch.obstacle = obstacle;
        touch.stretch = vec3(x, y, z);
        touch.normal = unpacked_direction(rods[slot(strand, vertex, STRAIN)].w);
    }
    return touch;
}

/// An edge whose ends have moved by so much, as contacts see it.
@if(contacts)
fn edge_of(strand: Strand, edge: u32, u_moved: vec3<f32>, v_moved: vec3<f32>) -> Edge {
    let root = positions[strand.guide].xyz;
    let u_before = positions[edge * step.strands + strand.guide].xyz;
    let v_before = positions[(edge + 1u) * step.strands + strand.guide].xyz;
    let u = u_before - root + (u_moved - strand.root_moved);
    let v = v_before - root + (v_moved - strand.root_moved);
    return Edge(u, v, u_moved, v_moved, u_before, v_before);
}
