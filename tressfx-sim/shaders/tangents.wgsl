// The end of a frame: places the follow strands beside their guides, and gives all strands unit tangents towards the tip, the
// mean of the directions of the two edges that meet. One thread a vertex of any strand: along x the guides, along y what each
// of them has, itself and its follow strands, along z the vertices. A follow strand is computed from its guide at the neighbors
// of a vertex too, so that no thread waits for what another stores.

import package::grid::GROUP;
import package::root::root_of;
import package::step::step;
import package::vector::{NO_LENGTH, direction_or, rotate};

@if(!follows)
@group(0) @binding(1) var<storage, read> positions: array<vec4<f32>>;
@if(follows)
@group(0) @binding(1) var<storage, read_write> positions: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> strand_tangents: array<vec4<f32>>;
@if(follows)
@group(0) @binding(3) var<storage, read> follow_offsets: array<vec4<f32>>;

/// A vertex between the one before it and the one after it. At an end of the strand one of them is the vertex itself.
struct Neighborhood { before: vec3<f32>, here: vec3<f32>, after: vec3<f32> }

@compute @workgroup_size(GROUP)
fn tangents(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
            @builtin(local_invocation_index) lane: u32) {
    let vertex = group.z;
    // The grid may hold fewer than all guides.
    for (var guide = group.x * GROUP + lane; guide < step.guides; guide += groups.x * GROUP) {
        // All are loaded before something is stored: loads behind a store to the same buffer would wait for it.
        let here = positions[vertex * step.strands + guide];
        let before = positions[vertex_before(vertex) * step.strands + guide].xyz;
        let after = positions[vertex_after(vertex) * step.strands + guide].xyz;
        let offset = offset_of(guide, group.y);
        let strand = beside(Neighborhood(before, here.xyz, after), offset, vertex);
        var sum = directions(strand, vertex);
        if (dot(sum, sum) <= NO_LENGTH) { sum = nearest_edge(guide, offset, vertex); }
        let place = vertex * step.strands + group.y * step.guides + guide;
        @if(follows) {
            if (group.y > 0u) { positions[place] = vec4(strand.here, here.w); }
        }
        strand_tangents[place] = vec4(normalize(sum), 0.0);
    }
}

fn vertex_before(vertex: u32) -> u32 {
    return max(vertex, 1u) - 1u;
}

fn vertex_after(vertex: u32) -> u32 {
    return min(vertex + 1u, step.vertices - 1u);
}

/// The offset between the root of a guide and that of its strand of this number; 0 is the guide itself.
fn offset_of(guide: u32, number: u32) -> vec3<f32> {
    @if(follows) {
        if (number > 0u) {
            return rotate(root_of(guide).rotation, follow_offsets[(number - 1u) * step.guides + guide].xyz);
        }
    }
    return vec3(0.0);
}

/// The neighborhood of a vertex in the strand that has this offset from a guide.
fn beside(guide: Neighborhood, offset: vec3<f32>, vertex: u32) -> Neighborhood {
    return Neighborhood(
        placed(guide.before, offset, vertex_before(vertex)),
        placed(guide.here, offset, vertex),
        placed(guide.after, offset, vertex_after(vertex)),
    );
}

/// A vertex of the strand that has this offset from a guide.
fn placed(guide: vec3<f32>, offset: vec3<f32>, vertex: u32) -> vec3<f32> {
    @if(!follows) { return guide; }
    @if(follows) {
        let spread = 1.0 + step.tip_separation * f32(vertex) / f32(step.vertices - 1u);
        return guide + spread * offset;
    }
}

/// The sum of the directions of the two edges that meet at a vertex; at an end there is one.
fn directions(strand: Neighborhood, vertex: u32) -> vec3<f32> {
    var sum = vec3(0.0);
    if (vertex > 0u) { sum += direction_or(strand.here - strand.before, vec3(0.0)); }
    if (vertex + 1u < step.vertices) { sum += direction_or(strand.after - strand.here, vec3(0.0)); }
    return sum;
}

/// The direction of the nearest edge that has one, first towards the tip, then towards the root; up if none has.
fn nearest_edge(guide: u32, offset: vec3<f32>, vertex: u32) -> vec3<f32> {
    for (var distance = 0u; distance < step.vertices; distance++) {
        let after = vertex + distance;
        if (after + 1u < step.vertices) {
            let found = edge(guide, offset, after);
            if (dot(found, found) > NO_LENGTH) { return found; }
        }
        if (vertex > distance) {
            let found = edge(guide, offset, vertex - distance - 1u);
            if (dot(found, found) > NO_LENGTH) { return found; }
        }
    }
    return vec3(0.0, 1.0, 0.0);
}

fn edge(guide: u32, offset: vec3<f32>, vertex: u32) -> vec3<f32> {
    let here = positions[vertex * step.strands + guide].xyz;
    let after = positions[(vertex + 1u) * step.strands + guide].xyz;
    return placed(after, offset, vertex + 1u) - placed(here, offset, vertex);
}
