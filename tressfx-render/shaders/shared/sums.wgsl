// Colour and opacity of many fragments as sums of integers: whatever the order in which they are added, the sums are the
// same to the bit.

import package::fragment::OPAQUE;

// Sums stop here instead of starting again from zero: no summand is larger.
const FULL: u32 = 0x7fffffffu;
const OPTICAL_UNIT: f32 = 16384.0;

// -log2(1 - alpha): its sum over fragments is that of their transmittances' product.
fn optical_depth(alpha: u32) -> u32 {
    return u32(round(-log2(max(1.0 - f32(alpha) / OPAQUE, 1.0 / 65536.0)) * OPTICAL_UNIT));
}

// A colour times a weight in units of alpha, up to 256, in parts of 1 / unit.
fn weighted(color: vec3<f32>, weight: u32, unit: f32) -> vec3<u32> {
    return vec3<u32>(round(min(color * (f32(weight) / OPAQUE), vec3(256.0)) * unit));
}

// What passes through a sum of optical depths.
fn transmittance_of(optical: u32) -> f32 {
    return exp2(-f32(optical) / OPTICAL_UNIT);
}

// The colour of a sum of weighted colours. `weight` is the sum of their weights, not 0.
fn mean_color(color: vec3<u32>, weight: u32, unit: f32) -> vec3<f32> {
    return vec3<f32>(color) * (OPAQUE / unit) / f32(weight);
}
