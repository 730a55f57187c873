// What the sums at the nodes come to: the slope of the pressure and the mean velocity. One thread a node.

import package::grid::{GROUP, thread_index};
import package::nodes::{node_at, node_index};
import package::volume::{VolumeNode, volume};

/// Mass and momentum.
@group(0) @binding(2) var<storage, read> sums: array<vec4<i32>>;
/// The mass that a node may have without pressure.
@group(0) @binding(3) var<storage, read> rest_masses: array<f32>;
@group(0) @binding(4) var<storage, read_write> node_values: array<VolumeNode>;

@compute @workgroup_size(GROUP)
fn volume_nodes(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) lane: u32) {
    let index = thread_index(group, groups, lane);
    let size = volume.nodes;
    if (index >= size.x * size.y * size.z) { return; }
    let sum = sums[index];
    // No vertex is near, so nobody asks for the slope.
    if (sum.x <= 0) {
        node_values[index] = VolumeNode(vec3(0.0), vec3(0.0));
        return;
    }
    let node = node_at(index, size);
    var slope: vec3<f32>;
    for (var axis = 0u; axis < 3u; axis++) {
        var before = node;
        var behind = node;
        before[axis] = max(node[axis], 1u) - 1u;
        behind[axis] = min(node[axis] + 1u, size[axis] - 1u);
        let apart = volume.cell * f32(behind[axis] - before[axis]);
        slope[axis] = (pressure(behind) - pressure(before)) / apart;
    }
    node_values[index] = VolumeNode(slope, vec3<f32>(sum.yzw) * (volume.fastest / f32(sum.x)));
}

/// By how much more mass there is than without pressure, as a share.
fn pressure(node: vec3<u32>) -> f32 {
    let index = node_index(node, volume.nodes);
    return max(f32(sums[index].x) / rest_masses[index] - 1.0, 0.0);
}
