// What every kernel knows of the section that it draws: its counts and its material.

import package::hash::hash;

// What of a section is drawn: an even sample of its strands, and of those each vertex `step`, the root and the tip.
struct LodUniform {
    // How many, of each strand how many vertices.
    strands: u32,
    vertices: u32,
    step: u32,
    // Share of its width that the last strand has.
    fade: f32,
}

struct SectionUniform {
    pose: mat4x4<f32>,
    // Colour and opacity at the root and at the tip.
    base: vec4<f32>,
    tip: vec4<f32>,
    strands: u32,
    guides: u32,
    vertices: u32,
    // In the unit of the positions; wider where a strand stands for several.
    fibre_radius: f32,
    lod: LodUniform,
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
    // Strands that are counted for shadows at most.
    shadow_strands: u32,
    // In w what it is as a multiple of the square of the logarithm of a colour.
    absorption: vec4<f32>,
    tip_absorption: vec4<f32>,
    // Share of a strand, from the root, that has the colour of the root, and 1 / (1 - tip_start).
    tip_start: f32,
    tip_scale: f32,
    hue_variation: f32,
    // How much of the colours that strands bring along is seen.
    own_colors: f32,
    // Strands that are shaded: copies have the colours of theirs.
    shaded_strands: u32,
    // How far copies are moved along each axis at most, in the unit of the positions.
    copy_spread: f32,
    unused: vec2<u32>,
}

// The vertex of the whole strand, which has so many, that a drawn one is.
fn stepped(lod: LodUniform, vertex: u32, vertices: u32) -> u32 {
    return min(vertex * lod.step, vertices - 1u);
}

// The strand of the buffers, which have so many, that a strand or a copy is: copies are numbered behind all strands, in their order.
fn source_of(strands: u32, strand: u32) -> u32 {
    @if(copies) { return strand % strands; }
    @if(!copies) { return strand; }
}

// How far a copy is moved away from its strand: to somewhere in a cube, all vertices alike.
@if(copies)
fn moved_aside(strands: u32, spread: f32, strand: u32) -> vec3<f32> {
    let seed = 3u * strand;
    let aside = spread * (2.0 * vec3(hash(seed), hash(seed + 1u), hash(seed + 2u)) - 1.0);
    return select(aside, vec3(0.0), strand < strands);
}

@if(!copies)
fn moved_aside(strands: u32, spread: f32, strand: u32) -> vec3<f32> {
    return vec3(0.0);
}

// How many strands have the width of all.
fn strands_of(lod: LodUniform) -> f32 {
    return f32(lod.strands - 1u) + lod.fade;
}

// Width of a strand as a share of what it has among others.
fn faded(lod: LodUniform, strand: u32) -> f32 {
    return select(1.0, lod.fade, strand + 1u == lod.strands);
}

// A number in [-1, 1) for a strand, half of which it shares with the strands that follow the same guide.
fn strand_random(strand: u32, guide: u32, stream: u32) -> f32 {
    return hash(guide * 2u + stream * 0x9e3779b9u) + hash(strand * 2u + 1u + stream * 0x9e3779b9u) - 1.0;
}
