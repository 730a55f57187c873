// What a group blends at once: slices of a tile, or a range of depths of one slice.

import package::fragment::depth_key;
import package::tiles::{SLICES, nearness_at, slice_distance};

// Fragments that a group has room for.
const ENTRIES: u32 = 868u;
// Above all keys of fragments.
const LAST_KEY: u32 = 0xffffffffu;
// Of its room, what a unit should fill.
const FILL: f32 = 0.8;
// Fragments that a reference leaves in a tile, before anything is known.
const FIRST_RATE: f32 = 4.0;
// However few fragments references leave, a unit has no more of them than ENTRIES / LEAST_RATE.
const LEAST_RATE: f32 = 0.25;

struct Unit {
    // The first slice, and the one after the last. All are done where the first is SLICES.
    first: u32,
    end: u32,
    // The first key, and the one after the last.
    low: u32,
    high: u32,
    // Fragments that a reference left in the last unit.
    rate: f32,
    // 1 where fragments are blended as their mean.
    is_mean: u32,
}

// Where the references of each slice of the tile begin, and where the last ones end.
var<workgroup> bounds: array<u32, SLICES + 1u>;

// As many slices from this one on as should fill the list.
fn unit_from(first: u32, rate: f32) -> Unit {
    let room = u32(FILL * f32(ENTRIES) / rate);
    var end = first + 1u;
    while end < SLICES && bounds[end + 1u] - bounds[first] <= room {
        end++;
    }
    return Unit(first, end, 0u, LAST_KEY, rate, 0u);
}

fn first_key(begin: f32, slice: u32) -> u32 {
    if slice == 0u {
        return 0u;
    }
    return depth_key(nearness_at(slice_distance(begin, slice)));
}

fn end_key(begin: f32, slice: u32) -> u32 {
    if slice == SLICES - 1u {
        return LAST_KEY;
    }
    return first_key(begin, slice + 1u);
}

// The unit behind one that has been blended.
fn behind(begin: f32, unit: Unit, rate: f32) -> Unit {
    if unit.high == LAST_KEY {
        return unit_from(unit.end, rate);
    }
    let step = unit.high - max(min(first_key(begin, unit.first), unit.high), unit.low);
    let room = LAST_KEY - unit.high;
    var high = unit.high + min(2u * min(step, LAST_KEY / 2u) + 1u, room);
    if high >= end_key(begin, unit.first) {
        high = LAST_KEY;
    }
    return Unit(unit.first, unit.end, unit.high, high, rate, 0u);
}

// Half of a unit that had too many fragments.
fn half_of(begin: f32, unit: Unit, rate: f32) -> Unit {
    if unit.end - unit.first > 1u {
        return Unit(unit.first, unit.first + (unit.end - unit.first) / 2u, 0u, LAST_KEY, rate, 0u);
    }
    if unit.high - unit.low <= 1u {
        return Unit(unit.first, unit.end, unit.low, unit.high, rate, 1u);
    }
    var low = max(unit.low, first_key(begin, unit.first));
    var high = min(unit.high, end_key(begin, unit.first));
    if low >= high {
        low = unit.low;
        high = unit.high;
    }
    let middle = clamp(low + (high - low) / 2u, unit.low + 1u, unit.high - 1u);
    return Unit(unit.first, unit.end, unit.low, middle, rate, 0u);
}

// What comes after a unit in which so many fragments were found.
fn next_unit(begin: f32, unit: Unit, found: u32) -> Unit {
    var rate = unit.rate;
    if unit.high == LAST_KEY && unit.low == 0u {
        let references = bounds[unit.end] - bounds[unit.first];
        rate = max(f32(found) / f32(max(references, 1u)), LEAST_RATE);
    }
    if found > ENTRIES && unit.is_mean == 0u {
        return half_of(begin, unit, rate);
    }
    return behind(begin, unit, rate);
}
