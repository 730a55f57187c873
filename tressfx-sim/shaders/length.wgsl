// Wind, length constraints, and the guard against non-finite strands. One thread a guide.
//
// All happens in one walk. Sweep k of the distance constraints runs one vertex behind sweep k - 1, which is the same as one
// sweep after the other, and behind the last sweep each vertex is placed at its exact rest length from its parent (dynamic
// follow the leader: Mueller, Kim, Chentanez 2012). So a vertex is loaded and stored once.

import package::constants::{CHUNK, GUIDES, STRANDS, SWEEPS, VERTICES};
import package::grid::{GROUP, thread_index};
import package::step::Step;
import package::vector::{NO_LENGTH, direction_or, is_finite, rotate};
@if(wind) import package::wind::{across_edge, wind_of};

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> rest_lengths: array<f32>;
@group(0) @binding(3) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> positions: array<vec4<f32>>;
/// Strands that were reset because they had become non-finite.
@group(0) @binding(5) var<storage, read_write> non_finite: atomic<u32>;

const DOWN: vec3<f32> = vec3(0.0, -1.0, 0.0);
// `CHUNK` vertices are loaded at once, into registers. One at a time, each would be waited for: a load cannot be moved up across
// the stores of the vertices before it.

/// Wind on a vertex needs the next one too.
@if(wind) const LOADED: u32 = CHUNK + 1u;
@if(!wind) const LOADED: u32 = CHUNK;
/// Share of a vertex's placement that its parent's velocity answers for. The parent does not move when its child is placed;
/// with no reaction at all strands gain energy without end, and at 1 it is never lost.
const REACTION: f32 = 0.9;
/// Share by which the way of a vertex is drawn to the mean of its neighbours'. Nothing else ends the zigzag from vertex to vertex
/// in which strands that gravity compresses would tremble for ever. What a strand's longest bend loses by it is a hundredth in a
/// sub-step, or less.
const SMOOTHING: f32 = min(0.25, f32(VERTICES * VERTICES) / 1000.0);

@compute @workgroup_size(GROUP)
fn length(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= GUIDES) { return; }
    @if(wind) let wind = wind_of(step, strand);
    @if(wind) var blown_edge = DOWN;

    // Inside of the walk positions are about the root, so that roundings are those of so small a thing as a strand: where a
    // vertex has come close to its parent, they grow by what the edge is short.
    var root = vec3(0.0);
    // Vertex `t - k` in `window[k]`, and in `lengths[k]` its rest length from its parent.
    var window: array<vec4<f32>, SWEEPS + 1u>;
    var lengths: array<f32, SWEEPS + 1u>;
    // The last vertex that was placed, where it was before the sub-step, and the ways that it and the one before it have made.
    var parent = vec4(0.0);
    var parent_past = vec3(0.0);
    var parent_way = vec3(0.0);
    var before_parent_way = vec3(0.0);
    var direction = DOWN;
    var finite = true;
    for (var start = 0u; start < VERTICES + SWEEPS; start += CHUNK) {
        var here: array<vec4<f32>, LOADED>;
        var from_parent: array<f32, CHUNK>;
        var past: array<vec3<f32>, CHUNK>;
        for (var i = 0u; i < LOADED; i++) {
            here[i] = positions[min(start + i, VERTICES - 1u) * STRANDS + strand];
        }
        for (var i = 0u; i < CHUNK; i++) {
            from_parent[i] = rest_lengths[(clamp(start + i, 1u, VERTICES - 1u) - 1u) * GUIDES + strand];
            past[i] = previous[(clamp(start + i, SWEEPS, VERTICES + SWEEPS - 1u) - SWEEPS) * GUIDES + strand].xyz;
        }
        if (start == 0u) { root = here[0].xyz; }
        for (var i = 0u; i < CHUNK; i++) {
            let t = start + i;
            for (var k = SWEEPS; k > 0u; k--) {
                window[k] = window[k - 1u];
                lengths[k] = lengths[k - 1u];
            }
            window[0] = vec4(here[i].xyz - root, here[i].w);
            lengths[0] = from_parent[i];
            @if(wind) {
                // The tip has no edge of its own and takes the last one's.
                blown_edge = direction_or(here[i + 1u].xyz - here[i].xyz, blown_edge);
                window[0] += vec4(select(vec3(0.0), across_edge(wind, blown_edge), here[i].w > 0.0), 0.0);
            }
            for (var k = 0u; k < SWEEPS; k++) {
                if (t > k && t < VERTICES + k) {
                    let correction = stretch(window[k + 1u], window[k], lengths[k]);
                    window[k + 1u] += vec4(window[k + 1u].w * correction, 0.0);
                    window[k] -= vec4(window[k].w * correction, 0.0);
                }
            }
            if (t >= SWEEPS && t < VERTICES + SWEEPS) {
                let placed = t - SWEEPS;
                let swept = window[SWEEPS];
                var vertex = swept;
                if (placed > 0u) {
                    direction = direction_or(swept.xyz - parent.xyz, direction);
                    let goal = parent.xyz + lengths[SWEEPS] * direction;
                    vertex = vec4(select(swept.xyz, goal, swept.w > 0.0), swept.w);
                }
                let way = vertex.xyz - (past[i] - root);
                if (placed > 0u && parent.w > 0.0) {
                    let zigzag = before_parent_way - parent_way + select(vec3(0.0), way - parent_way, vertex.w > 0.0);
                    let answer = REACTION * (vertex.xyz - swept.xyz) - SMOOTHING * zigzag;
                    previous[(placed - 1u) * GUIDES + strand] = vec4(parent_past + answer, 0.0);
                }
                // A pinned vertex has no way of its own: its child has one neighbour.
                before_parent_way = select(way, parent_way, parent.w > 0.0);
                parent_way = way;
                parent_past = past[i];
                parent = vertex;
                let world = root + parent.xyz;
                finite = finite && is_finite(world);
                positions[placed * STRANDS + strand] = vec4(world, parent.w);
            }
        }
    }
    @if(pinned_tips) reach(strand);
    if (!finite) { recover(strand); }
}

/// What moves the ends of an edge to its rest length, for an inverse mass of 1. Without branches, and with nothing on the way
/// from positions to result that the masses alone decide: the walk waits for this.
fn stretch(a: vec4<f32>, b: vec4<f32>, length: f32) -> vec3<f32> {
    let mass = a.w + b.w;
    let share = select(0.0, 1.0 / mass, mass > 0.0);
    let edge = b.xyz - a.xyz;
    let squared = dot(edge, edge);
    let stretched = share - share * length * inverseSqrt(max(squared, NO_LENGTH));
    return edge * select(0.0, stretched, squared > NO_LENGTH);
}

/// Puts a strand into its rest pose, at rest, and counts it.
fn recover(strand: u32) {
    for (var i = 0u; i < VERTICES; i++) {
        let vertex = rest[i * GUIDES + strand];
        let shape = rotate(step.head_rotation, vertex.xyz);
        positions[i * STRANDS + strand] = vec4(shape, vertex.w);
        previous[i * GUIDES + strand] = vec4(shape, 0.0);
    }
    atomicAdd(&non_finite, 1u);
}

/// Where the tip is pinned too, lengths are handed back and forth between both ends (FABRIK: Aristidou, Lasenby 2011).
@if(pinned_tips)
fn reach(strand: u32) {
    if (positions[(VERTICES - 1u) * STRANDS + strand].w > 0.0) { return; }
    for (var round = 0u; round < 4u; round++) {
        pull(strand, i32(VERTICES) - 1, -1);
        pull(strand, 0, 1);
    }
}

/// Places every movable vertex at its rest length from the vertex before it, from one end of the strand to the other.
@if(pinned_tips)
fn pull(strand: u32, end: i32, forward: i32) {
    var parent = positions[u32(end) * STRANDS + strand].xyz;
    var direction = DOWN;
    for (var i = end + forward; i >= 0 && i < i32(VERTICES); i += forward) {
        let vertex = positions[u32(i) * STRANDS + strand];
        let length = rest_lengths[u32(min(i, i - forward)) * GUIDES + strand];
        direction = direction_or(vertex.xyz - parent, direction);
        parent = select(vertex.xyz, parent + length * direction, vertex.w > 0.0);
        positions[u32(i) * STRANDS + strand] = vec4(parent, vertex.w);
    }
}
