// With which weight a fragment of a tail counts in its colour.
//
// What lies deep in a tail is seen less than what lies at its beginning. How much less is not known without order, but about: behind the nearest
// fragments hair goes on as dense as it is among them, and each layer stops as much light as this fragment does. How dense hair is has an error of
// its own, since the nearest are few: what is seen is the mean over all densities that so many fragments may come from (a gamma distribution), which
// falls more slowly than that of one density.

import package::fragment::OPAQUE;

// The nearest fragments of a pixel.
struct Nearest {
    // The nearness of the first and of the last.
    first: f32,
    last: f32,
    count: u32,
}

// No weight is less, in units of alpha, unless alpha is: of smaller ones sums of colours have too few parts.
const LEAST_WEIGHT: u32 = 32u;
// The nearest are taken to be at least this share of their nearness apart: of what is closer rounding is too large a part.
const THINNEST: f32 = 1e-6;

// Layers from the last of the nearest to a fragment.
fn layers_to(nearness: f32, nearest: Nearest) -> f32 {
    let behind = max(nearest.last - nearness, 0.0);
    let thick = max(nearest.first - nearest.last, max(THINNEST * nearest.first, 1e-30));
    return f32(max(nearest.count, 1u) - 1u) * behind / thick;
}

// In units of alpha.
fn weight_of(alpha: u32, nearness: f32, nearest: Nearest) -> u32 {
    let passes = 1.0 - f32(min(alpha, 65534u)) / OPAQUE;
    let count = f32(max(nearest.count, 1u));
    let depth = -log(passes) * layers_to(nearness, nearest);
    let seen = pow(1.0 + depth / count, -count);
    return max(u32(round(f32(alpha) * seen)), min(alpha, LEAST_WEIGHT));
}
