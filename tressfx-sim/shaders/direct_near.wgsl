// The sub-step of `direct` for the strands that it has left: those that may touch a collider. They make more rounds, and ask for their
// contacts in each of them. Few of them are on a GPU at once for each of its processors, so a small group of threads goes along one strand
// together; on a CPU each thread goes along one. The strands of the list go to groups, or threads, in turns.

@if(together)
import package::constants::TOGETHER;
@if(!together)
import package::hand_over::listed_round;
import package::hand_over::{listed_start, listed_strand};
import package::sub_step::counts;
@if(!together)
import package::sub_step::{end, rounds};
@if(together)
import package::sub_step_together::{end_together, listed_round_together, rounds_together};
import package::together::LANES;
@if(together)
import package::together::any_wants;

@compute @workgroup_size(LANES)
fn direct_near(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
               @builtin(local_invocation_index) lane: u32) {
    @if(!together) {
        let near = atomicLoad(&counts.near);
        for (var place = group.x + groups.x * lane; place < near; place += groups.x * LANES) {
            let strand = listed_strand(place);
            let start = listed_start(strand);
            end(strand, start, rounds(strand, start, listed_round(strand, start, place)));
        }
    }
    @if(together) {
        let near = atomicLoad(&counts.near);
        var place = group.x * (LANES / TOGETHER) + lane / TOGETHER;
        while (any_wants(lane, place < near)) {
            let strand = listed_strand(min(place, near - 1u));
            let start = listed_start(strand);
            let so_far = listed_round_together(strand, start, min(place, near - 1u), lane);
            let round = rounds_together(strand, start, so_far, lane, place < near);
            end_together(strand, start, round, lane, place < near);
            place += groups.x * (LANES / TOGETHER);
        }
    }
}
