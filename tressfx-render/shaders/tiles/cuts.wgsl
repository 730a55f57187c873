// Where the units of a quarter ended in the frame before, and where the one that closed it need not have gone on. What hair moves by in a frame changes little of how many fragments the nearest references
// leave, so that units that end behind as many again fit the list. One that does not is divided, as where nothing is known.

import package::tiles::PARTS_OF_A_QUARTER;
import package::unit::{ENTRIES, FILL};

const CUTS: u32 = 4u;
// A cut is the number of references before it. Of the logarithm of that and one so many bits are kept: it is kept up to 4.5 % too large; 0 is none.
const CUT_BITS: u32 = 8u;
const CODES_OF_AN_OCTAVE: f32 = 16.0;
// A cut this much farther than where a unit begins is not its end, but where it begins.
const NEAR_CUT: f32 = 1.06;
// Where a unit closed all pixels, the next frame takes as much of it as was blended, times this.
const END_RESERVE: f32 = 1.15;

// Of the frame before.
var<workgroup> cuts: array<f32, CUTS>;
// Of this frame, how many they are, and the fragments before the last one.
var<workgroup> new_cuts: array<f32, CUTS>;
var<workgroup> new_count: u32;
var<workgroup> new_found: u32;

// A quarter has one word. Where it is divided among groups, each keeps one of its cuts there, the first: with these bits of the word, from this one on.
const CUT_OF_PART: u32 = (1u << CUT_BITS) - 1u;
fn bit_of_part(parts: u32) -> u32 {
    return CUT_BITS * firstTrailingBit(parts);
}

// Of the word of the quarter what is for a group with these parts. One lane comes here.
fn recall_cuts(word: u32, parts: u32) {
    let packed = select((word >> bit_of_part(parts)) & CUT_OF_PART, word, parts == PARTS_OF_A_QUARTER);
    for (var i = 0u; i < CUTS; i++) {
        let code = extractBits(packed, CUT_BITS * i, CUT_BITS);
        cuts[i] = exp2(f32(code) / CODES_OF_AN_OCTAVE) - 1.0;
        new_cuts[i] = 0.0;
    }
    new_count = 0u;
    new_found = 0u;
}

// What is kept for the next frame.
fn pack_cuts() -> u32 {
    var packed = 0u;
    for (var i = 0u; i < CUTS; i++) {
        let code = ceil(log2(new_cuts[i] + 1.0) * CODES_OF_AN_OCTAVE);
        packed |= min(u32(code), CUT_OF_PART) << (CUT_BITS * i);
    }
    return packed;
}

// The next cut behind so many references; 0 where there is none.
fn next_cut(from_reference: f32) -> f32 {
    for (var i = 0u; i < CUTS; i++) {
        if cuts[i] > NEAR_CUT * from_reference {
            return cuts[i];
        }
    }
    return 0.0;
}

// A unit did not fit: the frame before says nothing of what is here. Each part of the unit would be tried up to the same cut again.
fn forget_cuts() {
    for (var i = 0u; i < CUTS; i++) {
        cuts[i] = 0.0;
    }
}

// A unit that ends behind so many references was blended: it is joined to the one before where both fit.
fn note_cut(to_reference: f32, found: u32) {
    if new_count == 0u || f32(new_found + found) > FILL * f32(ENTRIES) {
        new_count++;
        new_found = 0u;
    }
    if new_count <= CUTS {
        new_cuts[new_count - 1u] = to_reference;
    }
    new_found += found;
}

// The last unit that was blended closed all pixels. `share` is the part of its fragments that this took, 0 where that is not known. The cut moves to there, with a
// reserve.
fn note_end(from_reference: f32, to_reference: f32, share: f32) {
    if share > 0.0 && new_count <= CUTS {
        new_cuts[new_count - 1u] = mix(from_reference, to_reference, min(END_RESERVE * share, 1.0));
    }
}
