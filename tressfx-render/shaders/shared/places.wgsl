// Places in a pixel, 4, 16 or 64. Light passes hair at each of them for itself, so that hair which lies behind the edge of a strand is seen
// beside it, and not through it.

import package::constants::{LANES_OF_A_PIXEL, PLACES};

// They come by fours, from left to right.
const FOURS: u32 = PLACES / 4u;
// Those of a lane, where several share a pixel.
const OWN_FOURS: u32 = FOURS / LANES_OF_A_PIXEL;

// A number for each place of a lane.
alias Shares = array<vec4<f32>, OWN_FOURS>;

// Where four places are from the centre of the pixel, in widths of a place. No two places share a row or a column: each stands for a part
// of the pixel across a line along either. As each half of the columns, so each half of the rows of it has half of its places, and so on
// (the net of Hammersley, turned about so that none is at a corner).
fn columns_of(four: u32) -> vec4<f32> {
    return vec4<f32>(4u * four + vec4(0u, 1u, 2u, 3u)) - 0.5 * f32(PLACES - 1u);
}

fn rows_of(four: u32) -> vec4<f32> {
    let reversed = reverseBits(4u * four + vec4(0u, 1u, 2u, 3u)) / (0x80000000u / (PLACES / 2u));
    return vec4<f32>(reversed ^ vec4(0xaaaaaaaau & (PLACES - 1u))) - 0.5 * f32(PLACES - 1u);
}

// What a strand covers of a pixel: what is between two lines, both with one normal. Lengths are such that the corners of a pixel are 0.5 from
// its centre along the normal at most, and reach that.
struct Stripe {
    edges: vec2<f32>,
    // The normal's part to the right; its part down is what is left of 1.
    right: f32,
}

// What is within `half_width` of a line with the unit normal `normal` that passes at `distance` from the centre of the pixel.
fn stripe_of(distance: f32, half_width: f32, normal: vec2<f32>) -> Stripe {
    // Of the two normals of a line the one that leads down.
    let turn = select(1.0, -1.0, normal.y < 0.0);
    let scale = 1.0 / (abs(normal.x) + abs(normal.y));
    let edges = (vec2(-half_width, half_width) - turn * distance) * scale;
    return Stripe(clamp(edges, vec2(-0.5), vec2(0.5)), turn * normal.x * scale);
}

// A stripe in a word: 11 bits for either edge, 10 for the normal.
const EDGE_BITS: u32 = 11u;
const EDGE_STEPS: f32 = 2047.0;
const RIGHT_STEPS: f32 = 1023.0;

fn pack_stripe(stripe: Stripe) -> u32 {
    let edges = vec2<u32>(round((stripe.edges + 0.5) * EDGE_STEPS));
    let right = u32(round((stripe.right + 1.0) * (0.5 * RIGHT_STEPS)));
    return edges.x | (edges.y << EDGE_BITS) | (right << (2u * EDGE_BITS));
}

fn unpack_stripe(packed: u32) -> Stripe {
    let edges = vec2(extractBits(packed, 0u, EDGE_BITS), extractBits(packed, EDGE_BITS, EDGE_BITS));
    let right = f32(packed >> (2u * EDGE_BITS)) * (2.0 / RIGHT_STEPS) - 1.0;
    return Stripe(vec2<f32>(edges) * (1.0 / EDGE_STEPS) - 0.5, right);
}

// The share of each of four places that a stripe covers.
fn shares_of(stripe: Stripe, four: u32) -> vec4<f32> {
    let middle = (0.5 * f32(PLACES)) * (stripe.edges.x + stripe.edges.y);
    let half_width = (0.5 * f32(PLACES)) * (stripe.edges.y - stripe.edges.x);
    let across = columns_of(four) * stripe.right + rows_of(four) * (1.0 - abs(stripe.right)) - middle;
    return clamp(half_width + 0.5 - abs(across), vec4(0.0), vec4(min(2.0 * half_width, 1.0)));
}

// What makes shares opacities with the mean `alpha`. Up to 1 it is a factor of shares; above, 2 less it is a factor of what they leave free.
fn strength_of(stripe: Stripe, alpha: f32) -> f32 {
    var sum = 0.0;
    for (var four = 0u; four < FOURS; four++) {
        sum += dot(shares_of(stripe, four), vec4(1.0));
    }
    let mean = sum / f32(PLACES);
    if alpha > mean {
        return 2.0 - (1.0 - alpha) / max(1.0 - mean, 1e-6);
    }
    return alpha / max(mean, 1e-6);
}

// The opacity of a strand at each place of a lane, whose first four is `first`.
fn parts_of(stripe: Stripe, strength: f32, first: u32) -> Shares {
    let factor = min(strength, 2.0 - strength);
    let least = max(strength - 1.0, 0.0);
    var parts: Shares;
    for (var i = 0u; i < OWN_FOURS; i++) {
        parts[i] = saturate(shares_of(stripe, first + i) * factor + least);
    }
    return parts;
}

// Opacities with the mean `alpha` in two words, 16 bits each: those of 4 places, or what more are made from. Of the strength it is the root: that of
// a faint fragment is small.
fn pack_parts(stripe: Stripe, alpha: f32) -> vec2<u32> {
    let strength = strength_of(stripe, alpha);
    if PLACES == 4u {
        let parts = parts_of(stripe, strength, 0u);
        return vec2(pack2x16unorm(parts[0].xy), pack2x16unorm(parts[0].zw));
    }
    return vec2(pack2x16unorm(stripe.edges + 0.5), pack2x16unorm(vec2(0.5 * stripe.right + 0.5, sqrt(0.5 * strength))));
}

fn unpack_parts(packed: vec2<u32>, first: u32) -> Shares {
    if PLACES == 4u {
        var parts: Shares;
        parts[0] = vec4(unpack2x16unorm(packed.x), unpack2x16unorm(packed.y));
        return parts;
    }
    let right_and_root = unpack2x16unorm(packed.y);
    let stripe = Stripe(unpack2x16unorm(packed.x) - 0.5, 2.0 * right_and_root.x - 1.0);
    return parts_of(stripe, 2.0 * right_and_root.y * right_and_root.y, first);
}

// The same for all places.
fn all_places(share: f32) -> Shares {
    var shares: Shares;
    for (var i = 0u; i < OWN_FOURS; i++) {
        shares[i] = vec4(share);
    }
    return shares;
}

fn mean_of(shares: Shares) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < OWN_FOURS; i++) {
        sum += dot(shares[i], vec4(0.25 / f32(OWN_FOURS)));
    }
    return sum;
}

// The mean of what is stopped of the light that comes to each place.
fn stopped(transmittance: Shares, parts: Shares) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < OWN_FOURS; i++) {
        sum += dot(transmittance[i] * parts[i], vec4(0.25 / f32(OWN_FOURS)));
    }
    return sum;
}

// What is left of the light that comes to each place.
fn passed(transmittance: Shares, parts: Shares) -> Shares {
    var left: Shares;
    for (var i = 0u; i < OWN_FOURS; i++) {
        left[i] = transmittance[i] * (1.0 - parts[i]);
    }
    return left;
}
