// Strands become fragments in the lists of pixels, one thread a segment.

import package::grid::{GROUP, thread_index};
import package::line::Paint;
import package::listed::{NO_SEGMENT, segment_of};
import package::ribbon::Ribbon;
import package::sink::{Sink, counters, pool};
import package::strands::{paint_of, ribbon_of, section, strand_at};
import package::walk::walk;

@if(bounded)
import package::sink::count_behind;

// One request to the pool a group instead of one a fragment: everybody waits for that counter.
var<workgroup> requested: atomic<u32>;
var<workgroup> granted: u32;
@if(bounded)
var<workgroup> behind: atomic<u32>;

// The number of the first of `count` nodes. The counter ends at the limit: nodes beyond the capacity do not exist, and one
// that wrapped would give nodes out twice.
fn request(count: u32) -> u32 {
    if count <= pool.small_request {
        return atomicAdd(&counters.fragments, count);
    }
    var old = atomicLoad(&counters.fragments);
    while old < pool.limit {
        let exchange = atomicCompareExchangeWeak(&counters.fragments, old, old + min(count, pool.limit - old));
        if exchange.exchanged {
            break;
        }
        old = exchange.old_value;
    }
    return old;
}

@compute @workgroup_size(GROUP)
fn fill(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
        @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        atomicStore(&requested, 0u);
        @if(bounded) { atomicStore(&behind, 0u); }
    }
    workgroupBarrier();
    let segment = segment_of(thread_index(group, groups, lane));
    var ribbon: Ribbon;
    var paint: Paint;
    if segment != NO_SEGMENT {
        let strand = strand_at(segment % section.lod.strands);
        ribbon = ribbon_of(strand, segment / section.lod.strands);
        paint = paint_of(strand, segment / section.lod.strands);
    }
    var counted: Sink;
    walk(ribbon, paint, &counted);
    let place = atomicAdd(&requested, counted.count);
    @if(bounded) { atomicAdd(&behind, counted.behind); }
    workgroupBarrier();
    if lane == 0u {
        granted = request(atomicLoad(&requested));
        @if(bounded) { count_behind(atomicLoad(&behind)); }
    }
    workgroupBarrier();
    var is_stored = counted.count > 0u && granted < pool.capacity;
    @if(bounded) { is_stored = counted.count + counted.behind > 0u; }
    if is_stored {
        var stored = Sink(granted + place, counted.count, 0u, 0u, 1u);
        walk(ribbon, paint, &stored);
    }
}
