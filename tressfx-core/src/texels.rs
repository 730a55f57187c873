//! Where the texels of a picture are that repeats.

/// The texels on both sides of a texture coordinate along one axis, of so many, and how far it is from the first to the second. Their middles are at
/// `(i + 0.5) / texels`, and beyond 0 and 1 the picture repeats.
pub fn texels_beside(x: f64, texels: u32) -> ([usize; 2], f64) {
    let texels = f64::from(texels);
    let at = (x - x.floor()) * texels - 0.5;
    let low = at.floor();
    let wrapped = |texel: f64| texel.rem_euclid(texels).min(texels - 1.0) as usize;
    ([wrapped(low), wrapped(low + 1.0)], at - low)
}
