// Corner `index` of a triangle that covers the whole target.
fn cover(index: u32) -> vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

// Corner `index`, of six, of the texel `texel` in a target of `size` texels.
fn texel_corner(texel: vec2<u32>, size: vec2<u32>, index: u32) -> vec4<f32> {
    let corner = vec2<u32>(select(0u, 1u, index == 1u || index == 2u || index == 4u), select(0u, 1u, index > 1u && index < 5u));
    let share = vec2<f32>(texel + corner) / vec2<f32>(size);
    return vec4<f32>(share.x * 2.0 - 1.0, 1.0 - share.y * 2.0, 0.5, 1.0);
}
