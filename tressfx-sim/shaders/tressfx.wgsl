// A sub-step of the method of TressFX: velocity shock propagation, integration with the pull to the global shape, local shape
// constraints, wind, length constraints, capsules; or back to the rest pose. One thread a guide.
//
// All stages go along the strand in one walk, each behind the one before it, and so do the iterations of the constraints: an
// iteration may go on where the iteration before it is done with the vertices that it needs. Results are those of one stage after
// the other, and a vertex is loaded and stored once. What the stages are at is in registers, so a strand may be of any length.

import package::constants::{CHUNK, LENGTHS, LOCAL};
@if(capsules)
import package::contact::{clear_distance, pushed_out};
import package::grid::{GROUP, thread_index};
import package::integrate::{Free, integrated};
import package::lengths::{Stretching, stretched};
import package::local_shape::{Shaping, shaped};
import package::root::{Root, root_of, shape_of};
import package::step::step;
import package::vector::{DOWN, NO_LENGTH, direction_or, is_finite};
import package::wind::{across_edge, wind_of};

@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> positions: array<vec4<f32>>;
/// Strands that went back to their rest pose because they had become non-finite.
@group(0) @binding(4) var<storage, read_write> non_finite: atomic<u32>;

/// How far the last stage is behind the first one, vertices.
const LAG: u32 = LOCAL + 1u + 2u * LENGTHS;

/// A vertex as it is stored: positions relative to the centre of the groom, and the inverse mass with the rest position.
struct Stored { position: vec3<f32>, past: vec3<f32>, rest: vec4<f32> }

/// Where a walk is. Vertices are relative to `origin`, the new place of the first one: small numbers have small rounding errors.
struct Walk {
    origin: vec3<f32>,
    rest_before: vec3<f32>,
    shaping: Shaping,
    /// The vertex that the wind is at, and its rest length from its parent.
    calm: vec4<f32>,
    calm_length: f32,
    /// The direction of the last edge that had one.
    edge: vec3<f32>,
    stretching: Stretching,
    finite: bool,
    /// The vertex before the one that is stored next, and how far from there nothing touches a capsule.
    @if(capsules) parent: vec3<f32>,
    @if(capsules) free_distance: f32,
}

@compute @workgroup_size(GROUP)
fn tressfx(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= step.guides) { return; }
    let root = root_of(strand);
    if (step.reset != 0u) {
        rest_pose(strand, root);
        return;
    }
    let wind = wind_of(strand);
    var walk: Walk;
    walk.finite = true;
    walk.edge = DOWN;
    for (var k = 0u; k < LOCAL; k++) { walk.shaping.frames[k] = root.rotation; }

    // `CHUNK` vertices are loaded at once, while the ones before them are worked on: a load cannot be moved up across stores.
    var ahead = loaded(strand, 0u);
    for (var start = 0u; start < step.vertices + LAG; start += CHUNK) {
        var chunk = ahead;
        if (start + CHUNK < step.vertices) { ahead = loaded(strand, start + CHUNK); }
        for (var i = 0u; i < CHUNK; i++) {
            let t = start + i;
            if (t < step.vertices) { enter(&walk, root, chunk[i], strand, t); }
            shaped(&walk.shaping, t);
            if (t > LOCAL) { leave(&walk, root, wind, strand, t - LOCAL - 1u); }
            walk.calm = walk.shaping.vertices[LOCAL];
            walk.calm_length = walk.shaping.edges[LOCAL].w;
        }
    }
    if (!walk.finite) {
        rest_pose(strand, root);
        atomicAdd(&non_finite, 1u);
    }
}

fn loaded(strand: u32, start: u32) -> array<Stored, CHUNK> {
    var chunk: array<Stored, CHUNK>;
    for (var i = 0u; i < CHUNK; i++) {
        let vertex = min(start + i, step.vertices - 1u);
        let place = vertex * step.guides + strand;
        chunk[i] = Stored(positions[vertex * step.strands + strand].xyz, previous[place].xyz, rest[place]);
    }
    return chunk;
}

/// A vertex is moved freely, and handed to the local shape.
fn enter(walk: ptr<function, Walk>, root: Root, stored: Stored, strand: u32, vertex: u32) {
    let free = integrated(root, stored.position, stored.past, stored.rest, vertex);
    previous[vertex * step.guides + strand] = vec4(free.past, 0.0);
    if (vertex == 0u) {
        (*walk).origin = free.position;
        (*walk).rest_before = stored.rest.xyz;
    }
    let rest_edge = stored.rest.xyz - (*walk).rest_before;
    (*walk).rest_before = stored.rest.xyz;
    let length = sqrt(dot(rest_edge, rest_edge));
    (*walk).shaping.entered = vec4(free.position - (*walk).origin, stored.rest.w);
    (*walk).shaping.entered_edge = vec4(direction_or(rest_edge, vec3(0.0)), length);
}

/// The vertex that the local shape is done with meets the wind and goes to the length constraints, and what these are done with is
/// stored.
fn leave(walk: ptr<function, Walk>, root: Root, wind: vec3<f32>, strand: u32, vertex: u32) {
    var blown = (*walk).calm;
    // All edges are as they were before the wind. The tip has no edge of its own and takes the last one's.
    if (vertex + 1u < step.vertices) {
        (*walk).edge = direction_or((*walk).shaping.vertices[LOCAL].xyz - blown.xyz, (*walk).edge);
    }
    if (blown.w > 0.0) { blown += vec4(across_edge(wind, (*walk).edge), 0.0); }
    stretched(&(*walk).stretching, blown, (*walk).calm_length, vertex);
    if (vertex >= 2u * LENGTHS && vertex < step.vertices + 2u * LENGTHS) {
        store(walk, root, strand, vertex - 2u * LENGTHS);
    }
}

/// The vertex that all but the capsules are done with.
fn store(walk: ptr<function, Walk>, root: Root, strand: u32, vertex: u32) {
    let moved = (*walk).stretching.vertices[2u * LENGTHS];
    var point = (*walk).origin + moved.xyz;
    @if(capsules) {
        (*walk).free_distance -= distance(point, (*walk).parent);
        if (moved.w > 0.0 && (*walk).free_distance <= 0.0) {
            let clear = clear_distance(point);
            if (clear <= 0.0) {
                let place = vertex * step.guides + strand;
                let pushed = pushed_out(root, point, previous[place].xyz);
                previous[place] = vec4(pushed.past, 0.0);
                point = pushed.position;
            }
            (*walk).free_distance = max(clear, 0.0);
        }
        (*walk).parent = point;
    }
    (*walk).finite = (*walk).finite && is_finite(point);
    positions[vertex * step.strands + strand] = vec4(point, moved.w);
}

/// Puts a strand to its rest pose, at rest.
fn rest_pose(strand: u32, root: Root) {
    for (var i = 0u; i < step.vertices; i++) {
        let vertex = rest[i * step.guides + strand];
        let shape = shape_of(root, vertex.xyz);
        positions[i * step.strands + strand] = vec4(shape, vertex.w);
        previous[i * step.guides + strand] = vec4(shape, 0.0);
    }
}
