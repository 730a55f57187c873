//! Numbers that look random: `shaders/hash.wgsl` in f64, for the references of kernels.

/// One in [0, 1), the same on every device: PCG-RXS-M-XS (O'Neill 2014).
pub fn hash(seed: u32) -> f64 {
    let state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    f64::from(((word >> 22) ^ word) >> 8) / f64::from(1 << 24)
}
