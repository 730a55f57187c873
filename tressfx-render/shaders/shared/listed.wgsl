// Which segment of a section a thread has: the one of its number, or one of a list of those that may be seen.

import package::strands::section;

@if(listed)
struct SegmentList {
    count: u32,
    segments: array<u32>,
}

@if(listed)
@group(0) @binding(12) var<storage, read> listed: SegmentList;

const NO_SEGMENT: u32 = 0xffffffffu;

fn segment_of(thread: u32) -> u32 {
    @if(listed) {
        if thread >= listed.count {
            return NO_SEGMENT;
        }
        return listed.segments[thread];
    }
    @if(!listed) { return select(NO_SEGMENT, thread, thread < section.lod.strands * (section.lod.vertices - 1u)); }
}
