// Turns of the loops of a lane. Mesa's CPU driver ends all loops of a thread without a word once they have gone round 65,535 times together: lanes
// would then miss each other at barriers, and write where they must not. There (`few_turns`) a group ends before that, and counts the references
// of its tile behind there as dropped. The end of a loop counts too; loops of constant length are taken as unrolled but where it costs little.

import package::entries::{most_of_a_pixel, ties};
@if(places)
import package::places::{FOURS, OWN_FOURS};
@if(places)
import package::unit::ENTRIES_OF_A_LANE;

// For each chunk of references its looks, and for each segment that a lane draws the rows and the pixels of a quarter.
const TURNS_OF_A_CHUNK: u32 = 10u;
const TURNS_OF_A_SEGMENT: u32 = 23u;
// A lane has so many fragments to find the rank of, those of its pixel to blend, and, where depths are the same, to find its place among these.
const TURNS_OF_AN_ENTRY: u32 = 4u;
const TURNS_OF_A_TIE: u32 = 3u;
// Where a lane has several fours of places, for each entry that it blends the loops over these.
const LOOPS_OF_PLACES: u32 = 5u;
// Beside those, for each unit: the slices that are looked through for its end, and the pixels.
const TURNS_OF_A_UNIT: u32 = 64u;
// The last unit may take some more.
@if(!places)
const MOST_TURNS: u32 = 60000u;
@if(places)
const MOST_TURNS: u32 = select(60000u, 50000u, OWN_FOURS > 1u);

// At most so many in the lane that has the most.
var<workgroup> turns: u32;
// Turns of the unit that were counted and not made.
var<workgroup> unused: u32;

fn none_turned() {
    turns = 0u;
    unused = 0u;
}

fn may_go_on() -> bool {
    return turns < MOST_TURNS;
}

// One lane comes here, after each chunk of references of which a lane draws so many segments at most, and of which it drew some. (How many they are
// depends on the order of references, which is another one in each run: a group would end somewhere else. All of a unit are as many in each run.)
fn note_chunk(most_segments: u32, segments: u32) {
    turns += TURNS_OF_A_CHUNK + TURNS_OF_A_SEGMENT * most_segments;
    unused += TURNS_OF_A_SEGMENT * (most_segments - segments);
}

// One lane comes here, after each unit.
fn note_unit(is_sorted: bool) {
    turns += TURNS_OF_A_UNIT;
    turns -= unused;
    unused = 0u;
    if is_sorted {
        let same = atomicLoad(&ties);
        let most = most_of_a_pixel();
        turns += TURNS_OF_AN_ENTRY * most + TURNS_OF_A_TIE * select(0u, most + same, same > 0u);
        @if(places) {
            // All places are gone through for each fragment that a lane paints.
            turns += ENTRIES_OF_A_LANE * (FOURS + 1u) + select(0u, LOOPS_OF_PLACES * (OWN_FOURS + 1u) * most, OWN_FOURS > 1u);
        }
    }
}
