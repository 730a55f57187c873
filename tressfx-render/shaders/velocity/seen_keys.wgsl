// First pass of the motion of hair, one thread a segment: the key of the fragment that each pixel is seen to have.

import package::grid::{GROUP, thread_index};
import package::sink::Sink;
import package::walk::walk_segment;

@compute @workgroup_size(GROUP)
fn seen_keys(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
             @builtin(local_invocation_index) lane: u32) {
    var sink: Sink;
    walk_segment(thread_index(group, groups, lane), &sink);
}
