// First pass of ShortCut, one thread a segment: the depths of the K nearest fragments of each pixel, and the opacity of
// all of them.

import package::grid::{GROUP, thread_index};
import package::sink::{Sink, count_fragments};
import package::walk::walk_segment;

var<workgroup> counted: atomic<u32>;

@compute @workgroup_size(GROUP)
fn shortcut_depths(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                   @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        atomicStore(&counted, 0u);
    }
    workgroupBarrier();
    var sink: Sink;
    walk_segment(thread_index(group, groups, lane), &sink);
    atomicAdd(&counted, sink.count);
    workgroupBarrier();
    if lane == 0u {
        count_fragments(atomicLoad(&counted));
    }
}
