// What a strand leaves in a pixel.

struct Fragment {
    color: vec3<f32>,
    // See the lens: larger is nearer.
    nearness: f32,
    // In units of 1 / 65535; 0 is no fragment.
    alpha: u32,
}

const OPAQUE: f32 = 65535.0;

// Smaller is nearer. `nearness` is not negative, so that its bits are in its order.
fn depth_key(nearness: f32) -> u32 {
    return ~bitcast<u32>(nearness);
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
