// Places in a pixel, 4 or 16. Light passes hair at each of them for itself, so that hair which lies behind the edge of a strand is seen
// beside it, and not through it.

import package::constants::PLACES;

// They come by fours, from left to right.
const FOURS: u32 = PLACES / 4u;

// A number for each place.
alias Shares = array<vec4<f32>, FOURS>;

// The same in words: 16 bits each for 4 places, 8 bits for 16.
const WORDS: u32 = select(2u, 4u, PLACES == 16u);
alias PackedShares = array<u32, WORDS>;

// Where four places are from the centre of the pixel. No two places share a row or a column: each stands for a part of the pixel across a
// line along either. Of 16, one is in each of 4 x 4 cells too.
fn place_columns(four: u32) -> vec4<f32> {
    return (vec4(0.5, 1.5, 2.5, 3.5) + f32(4u * four)) / f32(PLACES) - 0.5;
}

fn place_rows(four: u32) -> vec4<f32> {
    // In cells the order of rows is that of the fours: 2, 0, 3, 1.
    let within = select(0u, 2u - 2u * (four % 2u) + four / 2u, FOURS > 1u);
    return (vec4(2.0, 0.0, 3.0, 1.0) * f32(FOURS) + f32(within) + 0.5) / f32(PLACES) - 0.5;
}

// What a strand covers of a pixel: what is within `half_width` of a line with the unit normal `normal` that passes at `distance` from the
// centre of the pixel.
struct Stripe {
    distance: f32,
    half_width: f32,
    normal: vec2<f32>,
}

// Each place's share of a stripe.
fn shares_of(stripe: Stripe) -> Shares {
    let reach = (0.5 / f32(PLACES)) * (abs(stripe.normal.x) + abs(stripe.normal.y));
    let most = min(stripe.half_width / reach, 1.0);
    var shares: Shares;
    for (var i = 0u; i < FOURS; i++) {
        let across = stripe.distance + (place_columns(i) * stripe.normal.x + place_rows(i) * stripe.normal.y);
        shares[i] = clamp((stripe.half_width + reach - abs(across)) * (0.5 / reach), vec4(0.0), vec4(most));
    }
    return shares;
}

// The same for all places.
fn all_places(share: f32) -> Shares {
    var shares: Shares;
    for (var i = 0u; i < FOURS; i++) {
        shares[i] = vec4(share);
    }
    return shares;
}

fn mean_of(shares: Shares) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < FOURS; i++) {
        sum += dot(shares[i], vec4(1.0 / f32(PLACES)));
    }
    return sum;
}

// The opacity of a strand at each place, with the mean `alpha`: all shares smaller by one factor, or what they leave free.
fn parts_of(stripe: Stripe, alpha: f32) -> Shares {
    let shares = shares_of(stripe);
    let mean = mean_of(shares);
    let grows = alpha > mean;
    let factor = select(alpha, 1.0 - alpha, grows) / max(select(mean, 1.0 - mean, grows), 1e-6);
    var parts: Shares;
    for (var i = 0u; i < FOURS; i++) {
        parts[i] = saturate(shares[i] * factor + select(0.0, 1.0 - factor, grows));
    }
    return parts;
}

// The mean of what is stopped of the light that comes to each place.
fn stopped(transmittance: Shares, parts: Shares) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < FOURS; i++) {
        sum += dot(transmittance[i] * parts[i], vec4(1.0 / f32(PLACES)));
    }
    return sum;
}

// What is left of the light that comes to each place.
fn passed(transmittance: Shares, parts: Shares) -> Shares {
    var left: Shares;
    for (var i = 0u; i < FOURS; i++) {
        left[i] = transmittance[i] * (1.0 - parts[i]);
    }
    return left;
}

// 8 bits are a share of the largest: `unpack_parts` knows the mean.
fn pack_parts(parts: Shares) -> PackedShares {
    var packed: PackedShares;
    if PLACES == 4u {
        packed[0] = pack2x16unorm(parts[0].xy);
        packed[1] = pack2x16unorm(parts[0].zw);
        return packed;
    }
    var largest = vec4(1e-20);
    for (var i = 0u; i < FOURS; i++) {
        largest = max(largest, parts[i]);
    }
    let scale = 1.0 / max(max(largest.x, largest.y), max(largest.z, largest.w));
    for (var i = 0u; i < FOURS; i++) {
        packed[i] = pack4x8unorm(parts[i] * scale);
    }
    return packed;
}

fn unpack_parts(packed: PackedShares, mean: f32) -> Shares {
    var parts: Shares;
    if PLACES == 4u {
        parts[0] = vec4(unpack2x16unorm(packed[0]), unpack2x16unorm(packed[1]));
        return parts;
    }
    for (var i = 0u; i < FOURS; i++) {
        parts[i] = unpack4x8unorm(packed[i]);
    }
    let scale = mean / max(mean_of(parts), 1e-6);
    for (var i = 0u; i < FOURS; i++) {
        parts[i] = min(parts[i] * scale, vec4(1.0));
    }
    return parts;
}

// Whether one comes first in an order that means nothing but is the same in every run; `if_same` where there is no difference.
fn is_less_packed(a: PackedShares, b: PackedShares, if_same: bool) -> bool {
    for (var i = 0u; i < WORDS; i++) {
        if a[i] != b[i] {
            return a[i] < b[i];
        }
    }
    return if_same;
}

// A stripe in a word: both edges, 11 bits each, and 10 bits of the normal. It moves no edge within the pixel by more than 0.0015 pixels.

// Edges farther from the centre than any place is are as good as at this distance.
const FARTHEST: f32 = 0.75;
const EDGE_BITS: u32 = 11u;
const EDGE_STEPS: f32 = 2047.0;
const NORMAL_BITS: u32 = 10u;
const NORMAL_STEPS: f32 = 1023.0;

fn pack_stripe(stripe: Stripe) -> u32 {
    // Of the two normals of a line the one that leads down.
    let turn = select(1.0, -1.0, stripe.normal.y < 0.0);
    let normal = turn * stripe.normal;
    let edges = clamp(vec2(-1.0, 1.0) * stripe.half_width - turn * stripe.distance, vec2(-FARTHEST), vec2(FARTHEST));
    let steps = vec2<u32>(round((edges + FARTHEST) * (0.5 * EDGE_STEPS / FARTHEST)));
    let right = normal.x / max(abs(normal.x) + normal.y, 1e-6);
    return steps.x | (steps.y << EDGE_BITS) | (u32(round((right + 1.0) * (0.5 * NORMAL_STEPS))) << (2u * EDGE_BITS));
}

fn unpack_stripe(packed: u32) -> Stripe {
    let steps = vec2<f32>(vec2(extractBits(packed, 0u, EDGE_BITS), extractBits(packed, EDGE_BITS, EDGE_BITS)));
    let edges = steps * (2.0 * FARTHEST / EDGE_STEPS) - FARTHEST;
    let right = f32(packed >> (2u * EDGE_BITS)) * (2.0 / NORMAL_STEPS) - 1.0;
    return Stripe(-0.5 * (edges.x + edges.y), 0.5 * (edges.y - edges.x), normalize(vec2(right, 1.0 - abs(right))));
}
