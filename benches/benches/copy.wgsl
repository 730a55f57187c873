// As many bytes as a kernel reads and writes, and nothing done with them.

import package::grid::{GROUP, thread_index};

@group(0) @binding(0) var<storage, read> vectors: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read_write> copied: array<vec4<f32>>;

@compute @workgroup_size(GROUP)
fn copy(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
        @builtin(local_invocation_index) lane: u32) {
    let index = thread_index(group, groups, lane);
    if (index < arrayLength(&vectors)) { copied[index] = vectors[index]; }
}
