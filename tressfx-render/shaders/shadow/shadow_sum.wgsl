// The light that fibres take up to the end of each cell, along the way of each light. One thread a row of cells that lie behind each other.

import package::frames::ShadowUniform;
import package::grid::{GROUP, thread_index};

@group(0) @binding(0) var<uniform> shadow: ShadowUniform;
@group(0) @binding(1) var<storage, read_write> cells: array<u32>;

const SKIN: u32 = 0x80000000u;
// What skin takes: an optical depth of 16.
const SKIN_DEPTH: u32 = 65536u;
// Cells that are read before any of them is written: none waits for another.
const AHEAD: u32 = 8u;

fn add(a: u32, b: u32) -> u32 {
    let sum = a + b;
    return select(sum, 0xffffffffu, sum < a);
}

@compute @workgroup_size(GROUP)
fn shadow_sum(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    let size = shadow.frames[1].size;
    let row = size.x * size.y;
    let index = 1u + i / row;
    if index >= shadow.end {
        return;
    }
    let first = shadow.frames[index].first + i % row;
    var sum = 0u;
    for (var start = 0u; start < size.z; start += AHEAD) {
        var taken: array<u32, AHEAD>;
        for (var i = 0u; i < AHEAD; i++) {
            taken[i] = cells[first + min(start + i, size.z - 1u) * row];
        }
        for (var i = 0u; i < min(AHEAD, size.z - start); i++) {
            sum = add(sum, taken[i] & ~SKIN);
            if (taken[i] & SKIN) != 0u {
                sum = add(sum, SKIN_DEPTH);
            }
            cells[first + (start + i) * row] = sum;
        }
    }
}
