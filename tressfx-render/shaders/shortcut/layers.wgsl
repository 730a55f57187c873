// The layers of a pixel: the keys of the K fragments that give it its colour, the largest first.

import package::fragment::{Fragment, seen_key};

// Of the sums of colours: finer than in a long list, since few fragments are summed up and the one of K = 1 may be faint.
const UNIT: f32 = 262144.0;

// A faint fragment has a layer only where others leave one free.
fn layer_key(fragment: Fragment) -> u32 {
    return seen_key(fragment.nearness, fragment.alpha);
}

// Two kernels compute the key of a fragment, and a driver may round them apart: in the last bits keys are not compared.
const ROUNDING: u32 = 4u;

fn is_in_front(key: u32, last: u32) -> bool {
    return key + ROUNDING >= last;
}
