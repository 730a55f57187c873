// A rod whose edges turn and never stretch, in one implicit sub-step: the rotations of all edges of a strand are found at once, by
// Newton's method with elimination from the tip to the root and back. One thread a guide. Forces are per mass of unit length, and
// times the square of the sub-step.
//
// A strand that may touch a collider is left to `direct_near` from there on: it takes many times as long, and the threads of a group would wait for it.

import package::grid::{GROUP, thread_index};
@if(colliders)
import package::hand_over::hand_over;
import package::rod::strand_of;
@if(colliders)
import package::rod_near::is_any;
import package::step::step;
import package::sub_step::{carry_held, end, rest_again, rounds};
import package::substitute::nothing_done;

@compute @workgroup_size(GROUP)
fn direct(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
          @builtin(local_invocation_index) lane: u32) {
    let guide = thread_index(group, groups, lane);
    if (guide >= step.guides) { return; }
    let strand = strand_of(guide);
    if (step.reset != 0u) {
        rest_again(strand);
        return;
    }
    let start = carry_held(strand);
    let round = rounds(strand, start, nothing_done(start));
    @if(colliders) {
        if (is_any(round.near)) {
            hand_over(strand, round);
            return;
        }
    }
    end(strand, start, round);
}
