// First pass of lists that do not hold all fragments, one thread a segment: the keys of the nearest fragments of each pixel.

import package::grid::{GROUP, thread_index};
import package::sink::Sink;
import package::strands::{paint_of, ribbon_of, section};
import package::walk::walk;

@compute @workgroup_size(GROUP)
fn nearest(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
           @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if i < section.strands * (section.vertices - 1u) {
        var sink: Sink;
        walk(ribbon_of(i % section.strands, i / section.strands), paint_of(i % section.strands, i / section.strands), &sink);
    }
}
