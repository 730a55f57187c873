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

// Each place's share within `half_width` of a line with the unit normal `normal` that passes at `distance` from the centre of the pixel.
fn shares_of(distance: f32, half_width: f32, normal: vec2<f32>) -> Shares {
    let reach = (0.5 / f32(PLACES)) * (abs(normal.x) + abs(normal.y));
    let most = min(half_width / reach, 1.0);
    var shares: Shares;
    for (var i = 0u; i < FOURS; i++) {
        let across = distance + (place_columns(i) * normal.x + place_rows(i) * normal.y);
        shares[i] = clamp((half_width + reach - abs(across)) * (0.5 / reach), vec4(0.0), vec4(most));
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

// Shares with the mean `covered`, all of them smaller by one factor, or what they leave free; times an opacity.
fn parts_with_mean(shares: Shares, covered: f32, opacity: f32) -> Shares {
    let mean = mean_of(shares);
    let grows = covered > mean;
    let factor = select(covered, 1.0 - covered, grows) / max(select(mean, 1.0 - mean, grows), 1e-6);
    var parts: Shares;
    for (var i = 0u; i < FOURS; i++) {
        parts[i] = saturate((shares[i] * factor + select(0.0, 1.0 - factor, grows)) * opacity);
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
