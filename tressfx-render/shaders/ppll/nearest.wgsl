// First pass of lists that do not hold all fragments, one thread a segment: the keys of the nearest fragments of each pixel.

import package::grid::{GROUP, thread_index};
import package::sink::Sink;
import package::walk::walk_segment;

@compute @workgroup_size(GROUP)
fn nearest(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) lane: u32) {
    var sink: Sink;
    walk_segment(thread_index(group, groups, lane), &sink);
}
