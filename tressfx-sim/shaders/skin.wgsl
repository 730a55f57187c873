// A mesh as its joints and morph targets move it: linear blend skinning. One thread a vertex.

import package::grid::{GROUP, thread_index};
import package::joint_matrix::{blended, cofactors_times, linear, transformed};
import package::vector::{across, direction_or};

/// A vertex of the bind pose. Joints are two in a word, the lower half first.
struct BoundVertex {
    position: vec3<f32>, joints_01: u32,
    normal: vec3<f32>, joints_23: u32,
    weights: vec4<f32>,
}

struct SkinnedVertex { position: vec4<f32>, normal: vec4<f32> }

/// What a morph target moves a vertex by; the fourth of `position` is the number of the target.
struct MorphOffset { position: vec4<f32>, normal: vec4<f32> }

@group(0) @binding(0) var<storage, read> bound_vertices: array<BoundVertex>;
@group(0) @binding(2) var<storage, read_write> vertices: array<SkinnedVertex>;
/// Of each vertex the first of its offsets, and behind the last vertex how many there are.
@if(morphs)
@group(0) @binding(3) var<storage, read> first_offsets: array<u32>;
@if(morphs)
@group(0) @binding(4) var<storage, read> morph_offsets: array<MorphOffset>;
@if(morphs)
@group(0) @binding(5) var<storage, read> morph_weights: array<f32>;
/// Unit tangents, and the side of the bitangent.
@if(tangents)
@group(0) @binding(6) var<storage, read> bound_tangents: array<vec4<f32>>;
@if(tangents)
@group(0) @binding(7) var<storage, read_write> tangents: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn skin(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
        @builtin(local_invocation_index) lane: u32) {
    let vertex = thread_index(group, groups, lane);
    if (vertex >= arrayLength(&bound_vertices)) { return; }
    let bound = bound_vertices[vertex];
    var position = bound.position;
    var normal = bound.normal;
    @if(morphs) {
        for (var i = first_offsets[vertex]; i < first_offsets[vertex + 1u]; i++) {
            let offset = morph_offsets[i];
            let weight = morph_weights[bitcast<u32>(offset.position.w)];
            position += weight * offset.position.xyz;
            normal += weight * offset.normal.xyz;
        }
    }
    let by = blended(bound.joints_01, bound.joints_23, bound.weights);
    let point = transformed(by, position);
    let up = direction_or(cofactors_times(by, normal), bound.normal);
    vertices[vertex] = SkinnedVertex(vec4(point, 1.0), vec4(up, 0.0));
    @if(tangents) {
        let along = linear(by, bound_tangents[vertex].xyz);
        // In the plane of the surface, as the normal has it.
        let flat = direction_or(along - up * dot(up, along), across(up));
        tangents[vertex] = vec4(flat, bound_tangents[vertex].w);
    }
}
