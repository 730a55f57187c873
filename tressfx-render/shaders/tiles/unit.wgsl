// What a group blends at once: a range of depths, from somewhere in a slice to somewhere in the same or in a later one.

import package::constants::LANES;
import package::cuts::{forget_cuts, next_cut, note_cut};
import package::fragment::depth_key;
import package::screen::nearness_at;
import package::tiles::{SLICES, slice_distance};

// How many fragments a group has room for.
const ENTRIES_OF_A_LANE: u32 = 3u;
const ENTRIES: u32 = ENTRIES_OF_A_LANE * LANES;
// Above all keys of fragments.
const LAST_KEY: u32 = 0xffffffffu;
// Of its room, what a unit should fill.
const FILL: f32 = 0.75;
// Fragments that a reference of the tile leaves in a quarter of it, where nothing is known of the frame before.
const FIRST_RATE: f32 = 2.0;
// However few fragments references leave, a unit has no more of them than ENTRIES / LEAST_RATE.
const LEAST_RATE: f32 = 0.0625;
// A rate falls at most to this share of itself from one unit to the next.
const FALL: f32 = 0.25;
// A unit ends with a slice where it would have less of the next one, or of its last one less would be left.
const NEAR_END: f32 = 0.15;

struct Unit {
    // The first slice, and the one after the last. All are done where the first is SLICES.
    first: u32,
    end: u32,
    // The first key, and the one after the last.
    low: u32,
    high: u32,
    // References of the tile before those of the unit, and before those behind it. Of a slice of which it has a part of the keys, it counts as many.
    from_reference: f32,
    to_reference: f32,
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

// References of the tile before those of a slice.
fn references_before(slice: u32) -> f32 {
    return f32(bounds[slice] - bounds[0]);
}

// The last slice, from `first` to `most`, before which there are at most so many references; `first` where there is none.
fn last_end(first: u32, most: u32, to_reference: f32) -> u32 {
    var end = first;
    var above = most + 1u;
    while above - end > 1u {
        let middle = (end + above) / 2u;
        if references_before(middle) <= to_reference {
            end = middle;
        } else {
            above = middle;
        }
    }
    return end;
}

// From a key in a slice on, to the end of the slice before another one.
fn unit_to(first: u32, end: u32, low: u32, from_reference: f32, rate: f32) -> Unit {
    return Unit(first, end, low, max(first_key(end), low + 1u), from_reference, references_before(end), rate, 0u);
}

// From a key in a slice on, with the references up to some number.
fn unit_until(first: u32, low: u32, from_reference: f32, to_reference: f32, rate: f32) -> Unit {
    if to_reference >= references_before(SLICES) {
        return unit_to(first, SLICES, low, from_reference, rate);
    }
    let slice = last_end(first, SLICES - 1u, to_reference);
    let before = references_before(slice);
    let share = (to_reference - before) / max(references_before(slice + 1u) - before, 1.0);
    if share <= NEAR_END && slice > first {
        return unit_to(first, slice, low, from_reference, rate);
    }
    if share >= 1.0 - NEAR_END {
        return unit_to(first, slice + 1u, low, from_reference, rate);
    }
    let begins = key_at(slice);
    let keys = u32(share * f32(max(key_at(slice + 1u), begins) - begins));
    let high = max(min(begins + keys, first_key(slice + 1u)), low + 1u);
    return Unit(first, slice + 1u, low, high, from_reference, to_reference, rate, 0u);
}

// From a key in a slice on, as many slices as should fill the list, at least one, and none from `most` on.
fn unit_of(first: u32, most: u32, low: u32, from_reference: f32, rate: f32) -> Unit {
    let room = FILL * f32(ENTRIES) / rate;
    let end = max(last_end(first, most, from_reference + room), first + 1u);
    if rate * (references_before(end) - from_reference) > f32(ENTRIES) {
        return unit_until(first, low, from_reference, from_reference + room, rate);
    }
    return unit_to(first, end, low, from_reference, rate);
}

// What to blend behind a key in a slice.
fn unit_from(first: u32, low: u32, from_reference: f32, rate: f32) -> Unit {
    if first >= SLICES || low >= last_key {
        return Unit(SLICES, SLICES, 0u, 0u, 0.0, 0.0, rate, 0u);
    }
    let cut = next_cut(from_reference);
    if cut > 0.0 {
        return unit_until(first, low, from_reference, cut, rate);
    }
    return unit_of(first, SLICES, low, from_reference, rate);
}

// A part of a unit in which too many fragments were found, none of them outside of two keys.
fn part_of(unit: Unit, found: u32, ends: vec2<u32>, rate: f32) -> Unit {
    if unit.end - unit.first > 1u {
        return unit_of(unit.first, unit.end - 1u, unit.low, unit.from_reference, rate);
    }
    let share = FILL * f32(ENTRIES) / f32(found);
    let to_reference = mix(unit.from_reference, unit.to_reference, share);
    // Rounding must not leave it as large as it was.
    let keys = min(u32(f32(ends.y - ends.x) * share), (ends.y - ends.x) / 2u);
    return Unit(unit.first, unit.end, ends.x, ends.x + keys + 1u, unit.from_reference, to_reference, rate, u32(ends.x == ends.y));
}

// What comes after a unit in which `found` fragments were found between two keys.
fn next_unit(unit: Unit, found: u32, ends: vec2<u32>) -> Unit {
    var rate = unit.rate;
    if unit.is_mean == 0u {
        rate = max(f32(found) / max(unit.to_reference - unit.from_reference, 1.0), max(LEAST_RATE, FALL * rate));
        if found > ENTRIES {
            forget_cuts();
            return part_of(unit, found, ends, rate);
        }
    }
    note_cut(unit.to_reference, found);
    let first = select(unit.end - 1u, unit.end, unit.high >= first_key(unit.end));
    return unit_from(first, unit.high, unit.to_reference, rate);
}
