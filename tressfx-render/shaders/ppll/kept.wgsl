// Which fragments of a pixel have a node where there is no room for all: the nearest ones, whenever they come.

// Two kernels compute the key of a fragment, and a driver may round them apart: in the last bits keys are not compared. What is
// kept beyond the nearest does not change the picture.
const ROUNDING: u32 = 4u;

// Larger is nearer; 0 is no fragment. `nearness` is not negative, so that its bits are in its order.
fn kept_key(nearness: f32) -> u32 {
    return bitcast<u32>(nearness) + 1u;
}

// The nearness of a key that is not 0.
fn kept_nearness(key: u32) -> f32 {
    return bitcast<f32>(key - 1u);
}

// Whether a fragment is one of the nearest, of which the last has the key `last`.
fn is_nearest(key: u32, last: u32) -> bool {
    return key + ROUNDING >= last;
}
