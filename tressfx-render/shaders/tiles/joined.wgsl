// The lanes of a pixel: each blends what its own places see, four of 16, eight of 64. In the end what they have becomes one.

import package::constants::LANES;
import package::entries::words;
import package::front::{Front, passes};
import package::quarter::PIXELS;

@if(places)
import package::constants::LANES_OF_A_PIXEL;
@if(places)
import package::places::OWN_FOURS;

@if(!places)
const LANES_OF_A_PIXEL: u32 = 1u;

// What a pixel has.
struct Joined {
    color: vec3<f32>,
    // How much of what is behind is seen.
    passes: f32,
    fragments: u32,
    // The key of the fragment whose depth it has, where that is written.
    seen: u32,
}

// Lanes of a pixel that have closed.
@if(places)
var<workgroup> closed_lanes: array<atomic<u32>, PIXELS>;

// The first lanes of all pixels come first, then the second ones.
fn pixel_of_lane(lane: u32) -> u32 {
    return lane % PIXELS;
}

// The first four places of a lane.
@if(places)
fn first_four(lane: u32) -> u32 {
    return lane / PIXELS * OWN_FOURS;
}

// Whether a lane is one of a pixel.
fn blends(lane: u32) -> bool {
    return lane < PIXELS * LANES_OF_A_PIXEL;
}

fn none_closed(pixel: u32) {
    @if(places) { atomicStore(&closed_lanes[pixel], 0u); }
}

// A lane of a pixel has closed. Whether it is the last one to do so.
fn is_last_to_close(pixel: u32) -> bool {
    @if(places) { return atomicAdd(&closed_lanes[pixel], 1u) + 1u == LANES_OF_A_PIXEL; }
    @if(!places) { return true; }
}

// What the lanes of a pixel have together: of the first one. Entries are no more needed. All lanes come here.
fn join(front: Front, seen: u32, lane: u32) -> Joined {
    var joined = Joined(front.color, passes(front), front.fragments, seen);
    if LANES_OF_A_PIXEL > 1u {
        if blends(lane) {
            let color = bitcast<vec3<u32>>(front.color);
            words[0][lane] = color.r;
            words[0][lane + LANES] = color.g;
            words[0][lane + 2u * LANES] = color.b;
            words[1][lane] = bitcast<u32>(joined.passes);
            words[1][lane + LANES] = joined.fragments;
            words[1][lane + 2u * LANES] = seen;
        }
        workgroupBarrier();
        if lane < PIXELS {
            joined = sum_of(lane);
        }
    }
    return joined;
}

fn sum_of(pixel: u32) -> Joined {
    var sum: Joined;
    for (var lane = pixel; lane < PIXELS * LANES_OF_A_PIXEL; lane += PIXELS) {
        sum.color += bitcast<vec3<f32>>(vec3(words[0][lane], words[0][lane + LANES], words[0][lane + 2u * LANES]));
        sum.passes += bitcast<f32>(words[1][lane]);
        sum.fragments = max(sum.fragments, words[1][lane + LANES]);
        sum.seen = max(sum.seen, words[1][lane + 2u * LANES]);
    }
    sum.color /= f32(LANES_OF_A_PIXEL);
    sum.passes /= f32(LANES_OF_A_PIXEL);
    return sum;
}
