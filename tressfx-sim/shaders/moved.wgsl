// How far strands have moved since this kernel ran before: the largest distance of a vertex, as a share of the length of its strand. One
// thread a guide.

import package::grid::{GROUP, thread_index};
import package::step::step;

@group(0) @binding(1) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> rest_lengths: array<f32>;
// Where guides were when it ran before.
@group(0) @binding(3) var<storage, read_write> measured: array<vec4<f32>>;
// The bits of the largest share, of all sections.
@group(0) @binding(4) var<storage, read_write> largest: atomic<u32>;

var<workgroup> of_group: atomic<u32>;

// Strands without a length move by so much of it as nobody sees.
const SHORTEST: f32 = 1e-20;

@compute @workgroup_size(GROUP)
fn moved(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) lane: u32) {
    if (lane == 0u) { atomicStore(&of_group, 0u); }
    workgroupBarrier();
    let guide = thread_index(group, groups, lane);
    if (guide < step.guides) {
        var length = 0.0;
        var farthest = 0.0;
        for (var vertex = 0u; vertex < step.vertices; vertex++) {
            let place = vertex * step.guides + guide;
            let here = positions[vertex * step.strands + guide];
            farthest = max(farthest, distance(here.xyz, measured[place].xyz));
            length += rest_lengths[place];
            measured[place] = here;
        }
        // Numbers that are not negative are in the order of their bits.
        atomicMax(&of_group, bitcast<u32>(farthest / max(length, SHORTEST)));
    }
    workgroupBarrier();
    if (lane == 0u) { atomicMax(&largest, atomicLoad(&of_group)); }
}
