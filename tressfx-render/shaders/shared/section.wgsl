// What every kernel knows of the section that it draws: its counts and its material.

struct SectionUniform {
    pose: mat4x4<f32>,
    // Colour and opacity at the root and at the tip.
    base: vec4<f32>,
    tip: vec4<f32>,
    strands: u32,
    guides: u32,
    vertices: u32,
    // In the unit of the positions.
    fibre_radius: f32,
    tip_width: f32,
    diffuse: f32,
    variation: f32,
    self_shadow: f32,
    // Strength and exponent of the highlights.
    primary: vec2<f32>,
    secondary: vec2<f32>,
    // Radians by which cuticle scales tilt, and how much that differs from strand to strand.
    tilt: f32,
    tilt_variation: f32,
    root_shade: f32,
    root_extent: f32,
    // The share of light that a fibre takes on its way to others.
    shadow_alpha: f32,
    // Of a fibre that scatters as glass: the variance of the lobe that it mirrors into, and what a radius of it takes at the root and at the tip.
    variance: f32,
    // How much of what fibres behind it give back is seen.
    multiple: f32,
    unused: u32,
    absorption: vec4<f32>,
    tip_absorption: vec4<f32>,
}

// A number in [0, 1) that looks random, the same on every device: PCG-RXS-M-XS.
fn hash(seed: u32) -> f32 {
    let state = seed * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32(((word >> 22u) ^ word) >> 8u) / 16777216.0;
}

// A number in [-1, 1) for a strand, half of which it shares with the strands that follow the same guide.
fn strand_random(strand: u32, guide: u32, stream: u32) -> f32 {
    return hash(guide * 2u + stream * 0x9e3779b9u) + hash(strand * 2u + 1u + stream * 0x9e3779b9u) - 1.0;
}
