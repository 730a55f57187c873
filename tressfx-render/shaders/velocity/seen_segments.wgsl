// Second pass of the motion of hair, one thread a segment: which segment the fragment that a pixel is seen to have is of.

import package::grid::{GROUP, thread_index};
import package::sink::{Sink, motion};
import package::walk::walk_segment;

@compute @workgroup_size(GROUP)
fn seen_segments(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                 @builtin(local_invocation_index) lane: u32) {
    let segment = thread_index(group, groups, lane);
    var sink = Sink(motion.first + segment + 1u);
    walk_segment(segment, &sink);
}
