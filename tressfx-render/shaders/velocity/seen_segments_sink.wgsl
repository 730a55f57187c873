// Fragments that have the key of their pixel become the number of their segment.

import package::fragment::{Fragment, NOT_FAINT, seen_key};
import package::motion::MotionUniform;
import package::screen::view;

@group(0) @binding(6) var<storage, read> keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> segments: array<atomic<u32>>;
@group(0) @binding(8) var<uniform> motion: MotionUniform;

// Two kernels compute the key of a fragment, and a driver may round them apart: in the last bits, and whether it is faint, keys are
// not compared.
const ROUNDING: u32 = 4u;

struct Sink {
    // The number of the segment, from 1.
    number: u32,
}

fn take(sink: ptr<function, Sink>, pixel: vec2<u32>, fragment: Fragment) {
    let index = pixel.y * view.size.x + pixel.x;
    let key = seen_key(fragment.nearness, fragment.alpha) & ~NOT_FAINT;
    let seen = keys[index] & ~NOT_FAINT;
    // Of fragments of one depth the last segment counts, however threads interleave.
    if max(key, seen) - min(key, seen) <= ROUNDING {
        atomicMax(&segments[index], (*sink).number);
    }
}
