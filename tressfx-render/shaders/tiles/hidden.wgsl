// What hair hides in a tile, as the next frame is told.

import package::screen::{distance_of, nearness_at};
import package::tiles::{NOTHING_HIDDEN, SLICES, TileInfo, is_cut, slice_distance, tiles};
import package::unit::{Unit, begin, last_end, references_before};

// A quarter hides what is behind a slice before which the tile has so many more references than were needed to close it, as a share of these: while hair moves, and while it
// rests. Then it closes again though its hair has moved.
const RESERVE: f32 = 1.0;
const RESERVE_AT_REST: f32 = 0.5;
const LEAST_RESERVE: f32 = 4.0;
// It is enough to have this share of them before what was left out already.
const KEPT_RESERVE: f32 = 0.5;
// Where references are many, hair is hidden from here on: so far behind the depth that was seen, as a share of it.
const CROWD_MARGIN: f32 = 0.25;
// What is hidden is farther behind what was seen than this share of the depth of all hair.
const DEPTH_MARGIN: f32 = 0.003;
// A distance behind all hair.
const FARTHEST: f32 = 1e30;

struct HairState {
    // Whether it moves, see `is_restless`.
    is_restless: bool,
    // Whether references are nearly too many for one round.
    is_crowded: bool,
}

// The distance behind which a quarter hides all, FARTHEST where it hides nothing. `closed` ends as the unit in which all its pixels were closed, at a
// distance; below 0 where they were not.
fn hidden_from(info: TileInfo, closed: Unit, seen_to: f32, hair: HairState) -> f32 {
    if seen_to < 0.0 {
        return FARTHEST;
    }
    let seen = max(seen_to - begin, 0.0);
    let needed = closed.to_reference;
    let reserve = max(needed * select(RESERVE_AT_REST, RESERVE, hair.is_restless), LEAST_RESERVE);
    let behind = references_before(SLICES) - needed;
    var distance = FARTHEST;
    if behind > reserve {
        distance = slice_distance(begin, last_end(closed.end, SLICES, needed + reserve) + 1u);
    } else if is_cut(info) && behind >= KEPT_RESERVE * reserve {
        distance = distance_of(info.farthest);
    } else if is_cut(info) {
        // More of it, not all: all hair of the tile would cost much, and be left out again in the next frame.
        distance = distance_of(info.farthest) + seen;
    }
    if hair.is_crowded && (is_cut(info) || behind > 0.0) {
        distance = min(distance, seen_to + CROWD_MARGIN * seen);
    }
    distance = max(distance, seen_to + DEPTH_MARGIN * tiles.depth);
    // A tile that leaves out nothing need not be drawn again.
    return select(FARTHEST, distance, distance < slice_distance(begin, SLICES));
}

// The complement of the bits of the nearness behind which it hides all.
fn hidden_by(info: TileInfo, closed: Unit, seen_to: f32, hair: HairState) -> u32 {
    let distance = hidden_from(info, closed, seen_to, hair);
    return select(~bitcast<u32>(max(nearness_at(distance), 0.0)), NOTHING_HIDDEN, distance >= FARTHEST);
}
