// A sub-step of the method of TressFX: velocity shock propagation, integration with the pull to the global shape, local shape
// constraints, wind, length constraints, capsules; or back to the rest pose. One thread a guide.
//
// All stages go along the strand in one walk, each behind the one before it, and so do the iterations of the constraints: an
// iteration may go on where the iteration before it is done with the vertices that it needs. Results are those of one stage after
// the other, and a vertex is loaded and stored once. What the stages are at is in registers, so a strand may be of any length.

import package::constants::{CHUNK, LENGTHS, LOCAL};
@if(capsules)
import package::contact::{clear_distance, pushed_out};
@if(fields)
import package::contact::longest_way;
import package::counts::Counts;
import package::grid::{GROUP, thread_index};
import package::integrate::{Carrier, carrier_of, integrated};
import package::lengths::{Stretching, stretched};
import package::local_shape::{Shaping, rest_edge_of, shaped};
import package::root::{Root, root_of, shape_of};
import package::step::step;
import package::vector::{DOWN, direction_or, is_finite};
import package::wind::{across_edge, wind_of};

@group(0) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> previous: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> positions: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> counts: Counts;

/// How far the last stage is behind the first one, vertices.
const LAG: u32 = LOCAL + 2u + 2u * LENGTHS;

/// A vertex as it is stored: positions relative to the centre of the groom, and the inverse mass with the rest position.
struct Stored { position: vec3<f32>, past: vec3<f32>, rest: vec4<f32> }

/// Vertices that are loaded at once.
struct Chunk { vertices: array<Stored, CHUNK> }

/// Where a walk is. Vertices are relative to `origin`, the new place of the first one: small numbers have small rounding errors.
struct Walk {
    origin: vec3<f32>,
    rest_before: vec3<f32>,
    /// The vertex that the wind is at, and its rest length from its parent.
    calm: vec4<f32>,
    calm_length: f32,
    /// The direction of the last edge that had one.
    edge: vec3<f32>,
    finite: bool,
    /// The vertex that was stored last, and how far from there nothing touches a capsule.
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
    var shaping: Shaping;
    var stretching: Stretching;
    walk.finite = true;
    walk.edge = DOWN;
    for (var k = 0u; k < LOCAL; k++) { shaping.frames[k] = root.rotation; }
    let carrier = carrier_of(root);

    // `CHUNK` vertices are loaded at once, while the ones before them are worked on: a load cannot be moved up across stores.
    var ahead = loaded(strand, 0u);
    for (var turn = 0u; turn * CHUNK < step.vertices + LAG; turn++) {
        // So a compiler knows which vertices are even.
        let start = turn * CHUNK;
        var chunk = ahead;
        if (start + CHUNK < step.vertices) { ahead = loaded(strand, start + CHUNK); }
        for (var i = 0u; i < CHUNK; i++) {
            let t = start + i;
            // The last stage comes first, so that it need not wait for the one before it. Where a stage has no vertex yet, its number wraps
            // around, beyond all of them.
            let done = t - LAG;
            if (done < step.vertices) { store(&walk, stretching.vertices[2u * LENGTHS], root, strand, done); }
            if (t < step.vertices) { enter(&walk, &shaping, carrier, chunk.vertices[i], strand, t); }
            shaped(&shaping, t);
            let next = shaping.vertices[LOCAL];
            let vertex = t - LOCAL - 1u;
            stretched(&stretching, blown(&walk, next.xyz, wind, vertex), walk.calm_length, vertex);
            walk.calm = next;
            walk.calm_length = shaping.edges[LOCAL].length;
        }
    }
    if (!walk.finite) {
        rest_pose(strand, root);
        atomicAdd(&counts.non_finite, 1u);
    }
}

fn loaded(strand: u32, start: u32) -> Chunk {
    var chunk: Chunk;
    for (var i = 0u; i < CHUNK; i++) {
        let vertex = min(start + i, step.vertices - 1u);
        let place = vertex * step.guides + strand;
        chunk.vertices[i] = Stored(positions[vertex * step.strands + strand].xyz, previous[place].xyz, rest[place]);
    }
    return chunk;
}

/// A vertex is moved freely, and handed to the local shape.
fn enter(walk: ptr<function, Walk>, shaping: ptr<function, Shaping>, carrier: Carrier, stored: Stored, strand: u32, vertex: u32) {
    let free = integrated(carrier, stored.position, stored.past, stored.rest, vertex);
    previous[vertex * step.guides + strand] = vec4(free.past, 0.0);
    (*walk).origin = select((*walk).origin, free.position, vertex == 0u);
    let parent = select((*walk).rest_before, stored.rest.xyz, vertex == 0u);
    (*walk).rest_before = stored.rest.xyz;
    (*shaping).entered = vec4(free.position - (*walk).origin, stored.rest.w);
    (*shaping).entered_edge = rest_edge_of(stored.rest.xyz - parent);
}

/// The vertex that the wind is at, after it; `next` is the one after it. All edges are as they were before the wind. The tip has no
/// edge of its own and takes the last one's.
fn blown(walk: ptr<function, Walk>, next: vec3<f32>, wind: vec3<f32>, vertex: u32) -> vec4<f32> {
    let calm = (*walk).calm;
    let direction = direction_or(next - calm.xyz, (*walk).edge);
    (*walk).edge = select((*walk).edge, direction, vertex < step.vertices - 1u);
    return calm + vec4(select(vec3(0.0), across_edge(wind, (*walk).edge), calm.w > 0.0), 0.0);
}

/// Stores a vertex that all stages but the capsules are done with.
fn store(walk: ptr<function, Walk>, moved: vec4<f32>, root: Root, strand: u32, vertex: u32) {
    var point = (*walk).origin + moved.xyz;
    @if(capsules) {
        (*walk).free_distance -= distance(point, (*walk).parent);
        // By how much what is next to a point has to be clear of it.
        var way = 0.0;
        @if(fields) {
            way = longest_way(root, point, previous[vertex * step.guides + strand].xyz);
        }
        if (moved.w > 0.0 && (*walk).free_distance <= way) {
            let clear = clear_distance(point);
            if (clear <= way) {
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
