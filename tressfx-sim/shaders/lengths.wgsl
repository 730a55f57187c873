// Length constraints. One thread a guide.
//
// All happens in one loop along the strand. Sweep k of the distance constraints runs one vertex behind sweep k - 1, which is
// the same as one sweep after the other, and behind the last sweep each vertex is placed at its exact rest length from its
// parent (dynamic follow the leader: Mueller, Kim, Chentanez 2012). So a vertex is loaded and stored once.

import package::constants::{CHUNK, SWEEPS};
import package::grid::{GROUP, thread_index};
import package::step::step;
import package::vector::{DOWN, NO_LENGTH, direction_or};

@group(0) @binding(1) var<storage, read> rest_lengths: array<f32>;
@group(0) @binding(2) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> positions: array<vec4<f32>>;

// `CHUNK` vertices are loaded at once, into registers. One at a time, each would be waited for: a load cannot be moved up across
// the stores of the vertices before it.

/// Share of a vertex's placement that the velocity of its parent is corrected by. The parent does not move when its child is
/// placed. Without the correction strands gain energy without end; with a share of 1 they never lose energy.
const REACTION: f32 = 0.9;

/// The vertices that the sweeps are at, relative to the root: vertex `t - k` in `vertices[k]`, and in `lengths[k]` its rest
/// length from its parent.
struct Window { vertices: array<vec4<f32>, SWEEPS + 1u>, lengths: array<f32, SWEEPS + 1u> }

/// The last vertex that was placed, relative to the root; where it was before the sub-step, relative to the centre of the groom;
/// the displacements of it and of the vertex before it; and the direction of its edge.
struct Placing {
    parent: vec4<f32>,
    past: vec3<f32>,
    displacement: vec3<f32>,
    displacement_before: vec3<f32>,
    direction: vec3<f32>,
}

@compute @workgroup_size(GROUP)
fn lengths(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= step.guides) { return; }

    // In this loop positions are relative to the root, because small numbers have small rounding errors. Where a vertex is
    // close to its parent, errors grow by the ratio of the rest length to the present length.
    var root = vec3(0.0);
    var window: Window;
    var placing = Placing(vec4(0.0), vec3(0.0), vec3(0.0), vec3(0.0), DOWN);
    let vertices = step.vertices;
    for (var start = 0u; start < vertices + SWEEPS; start += CHUNK) {
        var here: array<vec4<f32>, CHUNK>;
        var from_parent: array<f32, CHUNK>;
        var past: array<vec3<f32>, CHUNK>;
        for (var i = 0u; i < CHUNK; i++) {
            here[i] = positions[min(start + i, vertices - 1u) * step.strands + strand];
            from_parent[i] = rest_lengths[(clamp(start + i, 1u, vertices - 1u) - 1u) * step.guides + strand];
            past[i] = previous[(clamp(start + i, SWEEPS, vertices + SWEEPS - 1u) - SWEEPS) * step.guides + strand].xyz;
        }
        if (start == 0u) { root = here[0].xyz; }
        for (var i = 0u; i < CHUNK; i++) {
            let t = start + i;
            sweep(&window, vec4(here[i].xyz - root, here[i].w), from_parent[i], t);
            if (t >= SWEEPS && t < vertices + SWEEPS) {
                let placed = t - SWEEPS;
                let parent_is_free = placed > 0u && placing.parent.w > 0.0;
                let parent_past = place(&placing, window.vertices[SWEEPS], window.lengths[SWEEPS], past[i], root, placed == 0u);
                if (parent_is_free) { previous[(placed - 1u) * step.guides + strand] = vec4(parent_past, 0.0); }
                positions[placed * step.strands + strand] = vec4(root + placing.parent.xyz, placing.parent.w);
            }
        }
    }
    @if(pinned_tips) reach(strand);
}

/// Moves the window on to vertex `t`, at `vertex`, `length` from its parent: one edge of each sweep.
fn sweep(window: ptr<function, Window>, vertex: vec4<f32>, length: f32, t: u32) {
    for (var k = SWEEPS; k > 0u; k--) {
        (*window).vertices[k] = (*window).vertices[k - 1u];
        (*window).lengths[k] = (*window).lengths[k - 1u];
    }
    (*window).vertices[0] = vertex;
    (*window).lengths[0] = length;
    for (var k = 0u; k < SWEEPS; k++) {
        if (t > k && t < step.vertices + k) {
            let parent = (*window).vertices[k + 1u];
            let child = (*window).vertices[k];
            let correction = stretch(parent, child, (*window).lengths[k]);
            (*window).vertices[k + 1u] = parent + vec4(parent.w * correction, 0.0);
            (*window).vertices[k] = child - vec4(child.w * correction, 0.0);
        }
    }
}

/// Places the next vertex, which the sweeps have left at `swept` and which was at `past` before the sub-step, `length` from its
/// parent. Returns the new previous position of the parent: its velocity is corrected for the placing, and its displacement is
/// moved towards the mean of its neighbours' displacements. Only this ends the trembling of strands that gravity compresses, in
/// which neighbouring vertices move in opposite directions. The longest wave along a strand loses a hundredth of its motion in a
/// sub-step, or less.
fn place(placing: ptr<function, Placing>, swept: vec4<f32>, length: f32, past: vec3<f32>, root: vec3<f32>,
         is_root: bool) -> vec3<f32> {
    let last = *placing;
    var vertex = swept;
    if (!is_root) {
        (*placing).direction = direction_or(swept.xyz - last.parent.xyz, last.direction);
        let goal = last.parent.xyz + length * (*placing).direction;
        vertex = vec4(select(swept.xyz, goal, swept.w > 0.0), swept.w);
    }
    let displacement = vertex.xyz - (past - root);
    let zigzag = last.displacement_before - last.displacement
        + select(vec3(0.0), displacement - last.displacement, vertex.w > 0.0);
    // A pinned vertex has no displacement of its own: its child has one neighbour.
    (*placing).displacement_before = select(displacement, last.displacement, last.parent.w > 0.0);
    (*placing).displacement = displacement;
    (*placing).past = past;
    (*placing).parent = vertex;
    return last.past + (REACTION * (vertex.xyz - swept.xyz) - step.smoothing * zigzag);
}

/// What moves the ends of an edge to its rest length, for an inverse mass of 1. Without branches, and with nothing
/// between positions and result that depends on the masses alone: the loop along the strand waits for this.
fn stretch(a: vec4<f32>, b: vec4<f32>, length: f32) -> vec3<f32> {
    let mass = a.w + b.w;
    let share = select(0.0, 1.0 / mass, mass > 0.0);
    let edge = b.xyz - a.xyz;
    let squared = dot(edge, edge);
    let stretched = share - share * length * inverseSqrt(max(squared, NO_LENGTH));
    return edge * select(0.0, stretched, squared > NO_LENGTH);
}

/// Where the tip is pinned too, lengths are handed back and forth between both ends (FABRIK: Aristidou, Lasenby 2011).
@if(pinned_tips)
fn reach(strand: u32) {
    if (positions[(step.vertices - 1u) * step.strands + strand].w > 0.0) { return; }
    for (var round = 0u; round < 4u; round++) {
        pull(strand, i32(step.vertices) - 1, -1);
        pull(strand, 0, 1);
    }
}

/// Places every movable vertex at its rest length from the vertex before it, from one end of the strand to the other.
@if(pinned_tips)
fn pull(strand: u32, end: i32, forward: i32) {
    var parent = positions[u32(end) * step.strands + strand].xyz;
    var direction = DOWN;
    for (var i = end + forward; i >= 0 && i < i32(step.vertices); i += forward) {
        let vertex = positions[u32(i) * step.strands + strand];
        let length = rest_lengths[u32(min(i, i - forward)) * step.guides + strand];
        direction = direction_or(vertex.xyz - parent, direction);
        parent = select(vertex.xyz, parent + length * direction, vertex.w > 0.0);
        positions[u32(i) * step.strands + strand] = vec4(parent, vertex.w);
    }
}
