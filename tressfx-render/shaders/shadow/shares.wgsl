// The shares of lights that arrive at a vertex: their square roots in bytes, four to a word.

// The square root of the share of a light.
fn root_of_share(shares: vec2<u32>, light: u32) -> f32 {
    return unpack4x8unorm(shares[light / 4u] >> (8u * (light % 4u))).x;
}

// The same with the square root of another share of a light. (No array of roots: one that is indexed by a number lies in memory.)
fn with_root(shares: vec2<u32>, light: u32, root: f32) -> vec2<u32> {
    let shift = 8u * (light % 4u);
    let mask = select(vec2(0u, 0xffu << shift), vec2(0xffu << shift, 0u), light < 4u);
    let byte = (pack4x8unorm(vec4(root, 0.0, 0.0, 0.0)) & 0xffu) << shift;
    return (shares & ~mask) | (vec2(byte) & mask);
}
