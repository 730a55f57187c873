// The sub-step of `direct` for the strands that it has left: those that may touch a collider. They make more rounds, and ask for their
// contacts in each of them. Few of them are on a GPU at once for each of its processors, so groups are small, and the strands of the list go
// to groups in turns.

import package::hand_over::{listed_round, listed_start, listed_strand};
import package::sub_step::{counts, end, rounds};

/// Threads of a group.
const LANES: u32 = 32u;

@compute @workgroup_size(LANES)
fn direct_near(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    let near = atomicLoad(&counts.near);
    for (var place = group.x + groups.x * lane; place < near; place += groups.x * LANES) {
        let strand = listed_strand(place);
        let start = listed_start(strand);
        end(strand, start, rounds(strand, start, listed_round(strand, start, place)));
    }
}
