// A fragment of hair as a node of the list of its pixel: key, red and green, blue and alpha, the index of the next.

// Nodes are numbered from 1, so that a cleared head is an empty list.
const NOTHING: u32 = 0u;
const OPAQUE: f32 = 65535.0;

struct Counters {
    // Fragments that passed the depth test.
    fragments: atomic<u32>,
    // Of those, the ones that found no room in the pool.
    dropped: u32,
    // Pixels with at least one fragment.
    pixels_with_hair: atomic<u32>,
}

// Smaller is nearer. `nearness` is positive, so that its bits are in its order.
fn depth_key(nearness: f32) -> u32 {
    return ~bitcast<u32>(nearness);
}

// `alpha` is in units of 1 / 65535.
fn pack_node(nearness: f32, color: vec3<f32>, alpha: u32, next: u32) -> vec4<u32> {
    let blue = pack2x16float(vec2(color.b, 0.0));
    return vec4(depth_key(nearness), pack2x16float(color.rg), blue | (alpha << 16u), next);
}

fn node_color(node: vec3<u32>) -> vec3<f32> {
    return vec3(unpack2x16float(node.y), unpack2x16float(node.z & 0xffffu).x);
}

fn node_alpha(node: vec3<u32>) -> u32 {
    return node.z >> 16u;
}
