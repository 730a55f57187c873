// What a strand leaves in a pixel.

@if(places)
import package::places::Stripe;

struct Fragment {
    color: vec3<f32>,
    // See the lens: larger is nearer.
    nearness: f32,
    // In units of 1 / 65535; 0 is no fragment.
    alpha: u32,
    // What it covers.
    @if(places)
    stripe: Stripe,
}

const OPAQUE: f32 = 65535.0;

// Smaller is nearer. `nearness` is not negative, so that its bits are in its order.
fn depth_key(nearness: f32) -> u32 {
    return ~bitcast<u32>(nearness);
}

// The nearness of such a key.
fn nearness_of(key: u32) -> f32 {
    return bitcast<f32>(~key);
}

// Red and green, blue and alpha: half floats, and alpha as it is.
fn pack_color(fragment: Fragment) -> vec2<u32> {
    let blue = pack2x16float(vec2(fragment.color.b, 0.0));
    return vec2(pack2x16float(fragment.color.rg), blue | (fragment.alpha << 16u));
}

fn packed_color(packed: vec2<u32>) -> vec3<f32> {
    return vec3(unpack2x16float(packed.x), unpack2x16float(packed.y & 0xffffu).x);
}

fn packed_alpha(packed: vec2<u32>) -> u32 {
    return packed.y >> 16u;
}

// Below this alpha, 0.02, a fragment is faint: at the edges of strands there are many that nobody sees.
const FAINT: u32 = 1311u;
const NOT_FAINT: u32 = 0x80000000u;

// The order in which fragments count as the nearest: larger is nearer, and what is faint comes last; 0 is no fragment. `nearness` is
// not negative, so that its bits are in its order and the highest is free.
fn seen_key(nearness: f32, alpha: u32) -> u32 {
    return (bitcast<u32>(nearness) + 1u) | select(0u, NOT_FAINT, alpha >= FAINT);
}

// The nearness of a key that is not 0.
fn seen_nearness(key: u32) -> f32 {
    return bitcast<f32>((key & ~NOT_FAINT) - 1u);
}
