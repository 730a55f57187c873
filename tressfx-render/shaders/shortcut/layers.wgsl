// The layers of a pixel: the keys of the K fragments that give it its colour, the largest first.

import package::fragment::Fragment;

// Below this alpha, 0.02, a fragment has a layer only where others leave one free: at the edges of strands there are many
// that nobody sees.
const FAINT: u32 = 1311u;
const NOT_FAINT: u32 = 0x80000000u;

// Of the sums of colours: finer than in a long list, since few fragments are summed up and the one of K = 1 may be faint.
const UNIT: f32 = 262144.0;

// Larger is nearer, and what is faint comes last; 0 is no fragment. `nearness` is not negative, so that its bits are in its
// order and the highest is free.
fn layer_key(fragment: Fragment) -> u32 {
    return (bitcast<u32>(fragment.nearness) + 1u) | select(0u, NOT_FAINT, fragment.alpha >= FAINT);
}

// Two kernels compute the key of a fragment, and a driver may round them apart: in the last bits keys are not compared.
const ROUNDING: u32 = 4u;

fn is_in_front(key: u32, last: u32) -> bool {
    return key + ROUNDING >= last;
}
