// The optical depth of the hair in each part of each pixel, one thread a segment of a list.

import package::grid::{GROUP, thread_index};
import package::sink::Sink;
import package::walk::walk_segment;

@compute @workgroup_size(GROUP)
fn occlusion_sums(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                  @builtin(local_invocation_index) lane: u32) {
    var sink: Sink;
    walk_segment(thread_index(group, groups, lane), &sink);
}
