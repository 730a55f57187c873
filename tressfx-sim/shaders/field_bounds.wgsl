// The box around the triangles of a mesh. One thread a triangle. Numbers are stored so that integers have their order; 0 is none.

import package::field_mesh::{build, is_sound, mesh_triangle};
import package::grid::{GROUP, thread_index};

/// The largest x, y and z, then what the least ones are as the largest.
@group(0) @binding(4) var<storage, read_write> extremes: array<atomic<u32>, 6>;

var<workgroup> of_group: array<atomic<u32>, 6>;

@compute @workgroup_size(GROUP)
fn field_bounds(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) lane: u32) {
    if (lane < 6u) { atomicStore(&of_group[lane], 0u); }
    workgroupBarrier();
    let index = thread_index(group, groups, lane);
    if (index < build.triangles) {
        let triangle = mesh_triangle(index);
        if (is_sound(triangle)) {
            let most = ordered(max(max(triangle.a, triangle.b), triangle.c));
            let least = ~ordered(min(min(triangle.a, triangle.b), triangle.c));
            for (var axis = 0u; axis < 3u; axis++) {
                atomicMax(&of_group[axis], most[axis]);
                atomicMax(&of_group[3u + axis], least[axis]);
            }
        }
    }
    workgroupBarrier();
    if (lane < 6u) { atomicMax(&extremes[lane], atomicLoad(&of_group[lane])); }
}

/// Integers in the order of the numbers; never 0 for a number.
fn ordered(v: vec3<f32>) -> vec3<u32> {
    let bits = bitcast<vec3<u32>>(v);
    return select(bits | vec3(0x80000000u), ~bits, bits >= vec3(0x80000000u));
}
