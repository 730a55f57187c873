//! What a smooth cylinder does to light that meets it at some distance from its middle.

use super::table::LOBES;

/// Index of refraction of hair.
pub(crate) const ETA: f64 = 1.55;

/// A ray across the fibre: where it goes and how much of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Angle on the outside between the ray and the normal, both seen along the fibre.
    gamma_i: f64,
    /// The same on the inside.
    gamma_t: f64,
    /// Share of light that is mirrored at each surface.
    mirrored: f64,
    /// Radii that a ray goes within the fibre from surface to surface.
    path: f64,
}

impl Crossing {
    /// `h` is the distance from the middle in radii, -1 to 1.
    pub(crate) fn new(h: f64, cos_theta_d: f64) -> Self {
        let cos_d = cos_theta_d.clamp(1e-6, 1.0);
        let sin_square = 1.0 - cos_d * cos_d;
        // Seen along the fibre the index is another (Bravais).
        let sin_gamma_t = h * cos_d / (ETA * ETA - sin_square).sqrt();
        let cos_theta_t = (1.0 - sin_square / (ETA * ETA)).sqrt();
        Self {
            gamma_i: h.asin(),
            gamma_t: sin_gamma_t.asin(),
            mirrored: fresnel(cos_d * (1.0 - h * h).max(0.0).sqrt()),
            path: 2.0 * (1.0 - sin_gamma_t * sin_gamma_t).sqrt() / cos_theta_t,
        }
    }

    /// Share of the light that leaves by each lobe where a radius of the fibre takes `absorption`.
    pub(crate) fn shares(&self, absorption: f64) -> [f64; LOBES] {
        let (f, t) = (self.mirrored, (-absorption * self.path).exp());
        let through = (1.0 - f) * (1.0 - f) * t;
        // What is left is a geometric series; with a mirror for a surface nothing gets in.
        let rest = if f * t < 1.0 { through * (f * t) * (f * t) / (1.0 - f * t) } else { 0.0 };
        [f, through, through * f * t, rest]
    }

    /// By how much lobe `p`, 0 to 2, turns around the fibre.
    pub(crate) fn turn(&self, p: usize) -> f64 {
        let p = p as f64;
        2.0 * p * self.gamma_t - 2.0 * self.gamma_i + p * std::f64::consts::PI
    }
}

/// Share of unpolarised light that is mirrored on the outside.
fn fresnel(cos_i: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (ETA * ETA)).sqrt();
    let parallel = (ETA * cos_i - cos_t) / (ETA * cos_i + cos_t);
    let across = (cos_i - ETA * cos_t) / (cos_i + ETA * cos_t);
    0.5 * (parallel * parallel + across * across)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_that_nothing_takes_leaves() {
        for step in 0..400 {
            let (h, cos) = (f64::from(step % 20) / 10.0 - 0.95, f64::from(step / 20) / 19.0);
            let sum: f64 = Crossing::new(h, cos).shares(0.0).iter().sum();
            assert!((sum - 1.0).abs() < 1e-12, "{h} {cos}: {sum}");
        }
        assert!((fresnel(1.0) - (0.55f64 / 2.55).powi(2)).abs() < 1e-15);
        assert!((fresnel(0.0) - 1.0).abs() < 1e-15);
    }
}
