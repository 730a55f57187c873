// First pass of ShortCut, one thread a segment: the depths of the K nearest fragments of each pixel, and the opacity of
// all of them.

import package::grid::{GROUP, thread_index};
import package::sink::{Sink, count_fragments};
import package::strands::{paint_of, ribbon_of, section};
import package::walk::walk;

var<workgroup> counted: atomic<u32>;

@compute @workgroup_size(GROUP)
fn shortcut_depths(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                   @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        atomicStore(&counted, 0u);
    }
    workgroupBarrier();
    let i = thread_index(group, groups, lane);
    if i < section.strands * (section.vertices - 1u) {
        var sink: Sink;
        walk(ribbon_of(i % section.strands, i / section.strands), paint_of(i % section.strands, i / section.strands), &sink);
        atomicAdd(&counted, sink.count);
    }
    workgroupBarrier();
    if lane == 0u {
        count_fragments(atomicLoad(&counted));
    }
}
