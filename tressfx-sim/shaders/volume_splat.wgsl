// Spreads the mass and the momentum of the guides over the nodes of a grid, with trilinear weights. Sums are of integers, so that no order of
// threads matters. One thread a vertex of a guide.

import package::grid::{GROUP, thread_index};
import package::nodes::{corner_of, node_index};
import package::step::step;
import package::volume::{place_of, volume, weight_of};
import package::volume_vertex::{positions, seen};
import package::wind::scrambled;

@group(0) @binding(4) var<storage, read> rest_lengths: array<f32>;
/// Four for each node: mass, and momentum along x, y and z.
@group(0) @binding(5) var<storage, read_write> sums: array<atomic<i32>>;

@compute @workgroup_size(GROUP)
fn volume_splat(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) lane: u32) {
    let thread = thread_index(group, groups, lane);
    if (thread >= step.guides * step.vertices) { return; }
    let guide = thread % step.guides;
    let vertex = thread / step.guides;
    let seen = seen(guide, vertex, positions[vertex * step.strands + guide].xyz);
    let place = place_of(seen.place);
    if (!place.is_inside) { return; }
    let mass = mass_of(guide, vertex);
    let velocity = seen.velocity / volume.fastest;
    for (var corner = 0u; corner < 8u; corner++) {
        let offset = corner_of(corner);
        let amount = mass * weight_of(place.share, offset);
        let first = 4u * node_index(place.node + offset, volume.nodes);
        let bits = scrambled(8u * thread + corner);
        atomicAdd(&sums[first], rounded(amount, bits));
        atomicAdd(&sums[first + 1u], rounded(amount * velocity.x, bits >> 8u));
        atomicAdd(&sums[first + 2u], rounded(amount * velocity.y, bits >> 16u));
        atomicAdd(&sums[first + 3u], rounded(amount * velocity.z, bits >> 24u));
    }
}

/// A guide stands for its follow strands too; a vertex has half of the edges beside it.
fn mass_of(guide: u32, vertex: u32) -> f32 {
    var length = rest_lengths[vertex * step.guides + guide];
    if (vertex > 0u) { length += rest_lengths[(vertex - 1u) * step.guides + guide]; }
    return 0.5 * length * volume.unit_mass * f32(step.strands / step.guides);
}

/// A whole number below or above, as often as the fraction says: in a large groom a vertex counts few, and all would be rounded the same way.
fn rounded(amount: f32, bits: u32) -> i32 {
    return i32(floor(amount + f32(bits & 0xffu) / 256.0));
}
