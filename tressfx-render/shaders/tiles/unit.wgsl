// What a group blends at once: slices of a tile, or a range of depths of one slice.

import package::fragment::depth_key;
import package::tiles::{SLICES, nearness_at, slice_distance};

// Lanes of a group, and how many fragments it has room for.
const LANES: u32 = 160u;
const ENTRIES_OF_A_LANE: u32 = 3u;
const ENTRIES: u32 = ENTRIES_OF_A_LANE * LANES;
// Above all keys of fragments.
const LAST_KEY: u32 = 0xffffffffu;
// Of its room, what a unit should fill.
const FILL: f32 = 0.75;
// Fragments that a reference of the tile leaves in a quarter of it, before anything is known.
const FIRST_RATE: f32 = 2.0;
// However few fragments references leave, a unit has no more of them than ENTRIES / LEAST_RATE.
const LEAST_RATE: f32 = 0.0625;

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

// Distance at which the slices of the tile begin.
var<workgroup> begin: f32;
// Where the references of each slice of the tile begin, and where the last ones end.
var<workgroup> bounds: array<u32, SLICES + 1u>;

// Behind this key not all fragments are found, and none is blended.
var<workgroup> last_key: u32;

fn key_at(slice: u32) -> u32 {
    return depth_key(max(nearness_at(slice_distance(begin, slice)), 0.0));
}

// The first key of a slice. What lies before the first slice and behind the last belongs to them.
fn first_key(slice: u32) -> u32 {
    if slice == 0u {
        return 0u;
    }
    if slice == SLICES {
        return last_key;
    }
    return min(key_at(slice), last_key);
}

fn unit_of(first: u32, end: u32, low: u32, high: u32, rate: f32) -> Unit {
    return Unit(first, end, low, high, rate, 0u);
}

// References of its slices.
fn references_of(unit: Unit) -> u32 {
    return bounds[unit.end] - bounds[unit.first];
}

// As many slices from this one on as should fill the list, at least one, and none from `most` on.
fn unit_from(first: u32, most: u32, rate: f32) -> Unit {
    if first == SLICES || first_key(first) >= last_key {
        return Unit(SLICES, SLICES, 0u, 0u, rate, 0u);
    }
    let room = u32(FILL * f32(ENTRIES) / rate);
    var end = first + 1u;
    var above = most + 1u;
    while above - end > 1u {
        let middle = (end + above) / 2u;
        if bounds[middle] - bounds[first] <= room {
            end = middle;
        } else {
            above = middle;
        }
    }
    let unit = unit_of(first, end, first_key(first), first_key(end), rate);
    let expected = rate * f32(references_of(unit));
    if end == first + 1u && expected > f32(ENTRIES) {
        return beginning_of(unit, FILL * f32(ENTRIES) / expected);
    }
    return unit;
}

// A share of the keys of a slice.
fn beginning_of(slice: Unit, share: f32) -> Unit {
    let nearest = max(slice.low, key_at(slice.first));
    let keys = u32(f32(max(key_at(slice.end), nearest) - nearest) * share);
    return unit_of(slice.first, slice.end, slice.low, min(nearest + keys + 1u, slice.high), slice.rate);
}

// The unit behind one in which `found` fragments were blended.
fn behind(unit: Unit, found: u32, rate: f32) -> Unit {
    let end = first_key(unit.end);
    if unit.high >= end {
        return unit_from(unit.end, SLICES, rate);
    }
    var keys = end - unit.high;
    if unit.is_mean == 0u {
        let growth = clamp(FILL * f32(ENTRIES) / f32(max(found, 1u)), 0.5, 4.0);
        keys = min(u32(min(f32(unit.high - unit.low) * growth, 1e9)) + 1u, keys);
    }
    return unit_of(unit.first, unit.end, unit.high, unit.high + keys, rate);
}

// A part of a unit in which too many fragments were found, none of them outside of two keys.
fn part_of(unit: Unit, found: u32, ends: vec2<u32>, rate: f32) -> Unit {
    if unit.end - unit.first > 1u {
        return unit_from(unit.first, unit.end - 1u, rate);
    }
    // Rounding must not leave it as large as it was.
    let keys = min(u32(f32(ends.y - ends.x) * (FILL * f32(ENTRIES) / f32(found))), (ends.y - ends.x) / 2u);
    var part = unit_of(unit.first, unit.end, ends.x, ends.x + keys + 1u, rate);
    part.is_mean = u32(ends.x == ends.y);
    return part;
}

// What comes after a unit in which `found` fragments were found between two keys.
fn next_unit(unit: Unit, found: u32, ends: vec2<u32>) -> Unit {
    var rate = unit.rate;
    if unit.low == first_key(unit.first) && unit.high == first_key(unit.end) {
        rate = max(f32(found) / f32(max(references_of(unit), 1u)), LEAST_RATE);
    }
    if found > ENTRIES && unit.is_mean == 0u {
        return part_of(unit, found, ends, rate);
    }
    return behind(unit, found, rate);
}
