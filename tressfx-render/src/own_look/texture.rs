//! A picture that colours strands.

use glam::DVec4;
use tressfx_core::texels::texels_beside;

/// A picture: sRGB and opacity, 8 bits each, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorTexture {
    size: [u32; 2],
    texels: Vec<[u8; 4]>,
    linear: Vec<f64>,
    mean: DVec4,
}

/// Texels that make no picture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a texture of {} x {} texels with {texels} of them: it takes at least one, and as many as it says", size[0], size[1])]
pub struct ColorTextureError {
    /// Width and height.
    pub size: [u32; 2],
    /// How many there are.
    pub texels: usize,
}

/// Linear light of a part of an sRGB colour, 0 to 1 (IEC 61966-2-1).
pub(super) fn linear(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    if part <= 0.040_45 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
}

impl ColorTexture {
    /// A picture of so many texels across and down.
    ///
    /// # Errors
    /// [`ColorTextureError`] where there are none, or not as many as that.
    pub fn new(size: [u32; 2], texels: Vec<[u8; 4]>) -> Result<Self, ColorTextureError> {
        let count = u64::from(size[0]) * u64::from(size[1]);
        if count == 0 || count != texels.len() as u64 {
            return Err(ColorTextureError { size, texels: texels.len() });
        }
        let linear = (0..256).map(|part| linear(f64::from(part) / 255.0)).collect();
        let mut made = Self { size, texels, linear, mean: DVec4::ZERO };
        made.mean = made.texels.iter().map(|&texel| made.color(texel)).sum::<DVec4>() / count as f64;
        Ok(made)
    }

    /// Texels across and down.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Linear RGB and opacity at texture coordinates, between texels bilinear: (0, 0) is the upper left corner, (1, 1) the lower right one, beyond them the picture
    /// repeats. Where they are not finite it is the mean of the picture.
    pub fn at(&self, uv: [f64; 2]) -> DVec4 {
        if !uv.iter().all(|x| x.is_finite()) {
            return self.mean;
        }
        let ([left, right], across) = texels_beside(uv[0], self.size[0]);
        let ([above, below], down) = texels_beside(uv[1], self.size[1]);
        let row = |y| self.texel(left, y).lerp(self.texel(right, y), across);
        row(above).lerp(row(below), down)
    }

    fn texel(&self, x: usize, y: usize) -> DVec4 {
        self.color(self.texels[y * self.size[0] as usize + x])
    }

    fn color(&self, [r, g, b, a]: [u8; 4]) -> DVec4 {
        let [r, g, b] = [r, g, b].map(|part| self.linear[usize::from(part)]);
        DVec4::new(r, g, b, f64::from(a) / 255.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black, white / red, clear blue.
    fn four() -> ColorTexture {
        ColorTexture::new([2, 2], vec![[0, 0, 0, 255], [255; 4], [255, 0, 0, 255], [0, 0, 255, 0]]).unwrap()
    }

    #[test]
    fn texels_are_where_their_middles_are_and_mixed_between() {
        let (black, white) = (DVec4::W, DVec4::ONE);
        let picture = four();
        assert_eq!(picture.at([0.25, 0.25]), black);
        assert_eq!(picture.at([0.75, 0.25]), white);
        assert_eq!(picture.at([0.25, 0.75]), DVec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(picture.at([0.75, 0.75]), DVec4::Z);
        assert_eq!(picture.at([0.5, 0.25]), black.lerp(white, 0.5));
        let mean = DVec4::new(0.5, 0.25, 0.5, 0.75);
        assert_eq!(picture.at([0.5, 0.5]), mean);
        let gray = ColorTexture::new([1, 1], vec![[188, 188, 188, 255]]).unwrap().at([0.3, 0.9]);
        assert!((gray.x - 0.502_886).abs() < 1e-5, "{gray}");
    }

    #[test]
    fn it_repeats_and_what_is_no_place_has_the_mean() {
        let picture = four();
        for (u, v) in [(0.1, 0.2), (0.0, 0.0), (0.99, 0.5)] {
            for (i, j) in [(1.0, 0.0), (-3.0, 2.0)] {
                assert!((picture.at([u, v]) - picture.at([u + i, v + j])).abs().max_element() < 1e-12);
            }
        }
        assert_eq!(picture.at([0.0, 0.25]), picture.at([1.0, 0.25]));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(picture.at([bad, 0.5]), DVec4::new(0.5, 0.25, 0.5, 0.75));
            assert_eq!(picture.at([0.5, bad]), DVec4::new(0.5, 0.25, 0.5, 0.75));
        }
        for wild in [1e30, -1e300, f64::MIN_POSITIVE, -1e-320, 4.0e15 + 0.5] {
            assert!(picture.at([wild, wild]).is_finite());
        }
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        for (size, texels) in [([0, 1], 0), ([2, 2], 3), ([u32::MAX, u32::MAX], 1)] {
            let error = ColorTexture::new(size, vec![[0; 4]; texels]).unwrap_err();
            assert!(error.to_string().contains(&format!("with {texels} of them")), "{error}");
        }
    }
}
