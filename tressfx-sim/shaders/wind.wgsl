// Wind: each vertex is moved by the part of its strand's wind that is across its edge. One thread a guide.

import package::grid::{GROUP, thread_index};
import package::step::step;
import package::vector::{DOWN, direction_or};

@group(0) @binding(1) var<storage, read_write> positions: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn wind(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
        @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if (strand >= step.guides) { return; }
    let wind = wind_of(strand);
    // All edges are as they were before the wind, so the next vertex is loaded before this one is stored.
    var here = positions[strand];
    var next = positions[step.strands + strand];
    var edge = DOWN;
    for (var i = 0u; i < step.vertices; i++) {
        let ahead = positions[min(i + 2u, step.vertices - 1u) * step.strands + strand];
        // The tip has no edge of its own and takes the last one's.
        edge = direction_or(next.xyz - here.xyz, edge);
        if (here.w > 0.0) {
            positions[i * step.strands + strand] = vec4(here.xyz + across_edge(wind, edge), here.w);
        }
        here = next;
        next = ahead;
    }
}

/// A mix of the four corners of the wind's cone that is the strand's own. The weights sum to 1.
fn wind_of(strand: u32) -> vec3<f32> {
    let bits = scrambled(strand);
    let x = f32(bits & 0xffffu) / 65535.0;
    let y = f32(bits >> 16u) / 65535.0;
    return (step.wind[0].xyz * (1.0 - x) + step.wind[1].xyz * x) * (1.0 - y)
        + (step.wind[2].xyz * (1.0 - x) + step.wind[3].xyz * x) * y;
}

/// The `lowbias32` hash of Chris Wellons: neighbouring strands get unrelated winds.
fn scrambled(value: u32) -> u32 {
    var x = value;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

/// What of a wind acts on an edge of unit direction `edge`: the part across it.
fn across_edge(wind: vec3<f32>, edge: vec3<f32>) -> vec3<f32> {
    return wind - dot(wind, edge) * edge;
}
