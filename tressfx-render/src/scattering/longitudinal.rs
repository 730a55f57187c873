//! The lobe along the fibre.

use super::table::LOBES;

/// Smoother fibres have lobes that are narrower than what changes from vertex to vertex.
const MIN_ROUGHNESS: f64 = 0.05;

/// The variances of the lobes of a fibre of a roughness from 0 to 1, with the fit and the factors of Chiang et al. 2015.
pub(crate) fn variances(roughness: f64) -> [f64; LOBES] {
    // NaN too becomes a number.
    let beta = if roughness > MIN_ROUGHNESS { roughness.min(1.0) } else { MIN_ROUGHNESS };
    let variance = (0.726 * beta + 0.812 * beta * beta + 3.7 * beta.powi(20)).powi(2);
    [1.0, 0.25, 4.0, 4.0].map(|factor| factor * variance)
}

/// `M` of d'Eon et al. 2011: a von Mises-Fisher lobe around the cone that a smooth fibre mirrors into, averaged around the cone. Its integral
/// over `cos(theta_r) d theta_r` is 1. Angles as sine and cosine; a cosine may be negative beyond the end of the fibre.
pub(crate) fn lobe(variance: f64, [sin_i, cos_i]: [f64; 2], [sin_r, cos_r]: [f64; 2]) -> f64 {
    let across = (cos_i * cos_r).abs();
    let exponent = (across - sin_i * sin_r - 1.0) / variance;
    exponent.exp() * bessel(across / variance) / (variance * (1.0 - (-2.0 / variance).exp()))
}

/// `exp(-x)` times the modified Bessel function of order 0, for `x` from 0: Abramowitz and Stegun 9.8.1 and 9.8.2.
pub(crate) fn bessel(x: f64) -> f64 {
    if x < 3.75 {
        let t = (x / 3.75).powi(2);
        let terms = [1.0, 3.515_622_9, 3.089_942_4, 1.206_749_2, 0.265_973_2, 0.036_076_8, 0.004_581_3];
        return (-x).exp() * terms.iter().rev().fold(0.0, |sum, term| sum * t + term);
    }
    let t = 3.75 / x;
    let terms = [
        0.398_942_28,
        0.013_285_92,
        0.002_253_19,
        -0.001_575_65,
        0.009_162_81,
        -0.020_577_06,
        0.026_355_37,
        -0.016_476_33,
        0.003_923_77,
    ];
    terms.iter().rev().fold(0.0, |sum, term| sum * t + term) / x.sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    fn turned(theta: f64) -> [f64; 2] {
        let (sine, cosine) = theta.sin_cos();
        [sine, cosine]
    }

    #[test]
    fn the_bessel_function_is_its_integral() {
        for x in [0.0, 0.1, 1.0, 3.7, 3.8, 10.0, 100.0, 2000.0] {
            let count = 20_000;
            let at = |k: u32| (x * ((f64::from(k) + 0.5) / f64::from(count) * PI).cos() - x).exp();
            let integral = (0..count).map(at).sum::<f64>() / f64::from(count);
            assert!((bessel(x) / integral - 1.0).abs() < 1e-6, "{x}: {} {integral}", bessel(x));
        }
    }

    /// The lobe as it is derived: light on a circle around the fibre, each direction spread by a von Mises-Fisher lobe.
    #[test]
    fn the_lobe_is_a_spread_circle_and_its_integral_is_1() {
        for roughness in [0.0, 0.1, 0.3, 0.6, 1.0] {
            for (variance, theta_i) in variances(roughness).into_iter().zip([0.2, -0.9, 1.3, 0.7]) {
                let (count, mut sum) = (4000, 0.0);
                let theta = |k: u32| PI * ((f64::from(k) + 0.5) / f64::from(count) - 0.5);
                for k in 0..count {
                    sum += lobe(variance, turned(theta_i), turned(theta(k))) * theta(k).cos() * PI / f64::from(count);
                }
                assert!((sum - 1.0).abs() < 1e-5, "{variance} {theta_i}: {sum}");
                for theta_r in [-theta_i, -theta_i + 0.05, 0.4] {
                    // Around the cone of half-angle pi / 2 - |theta_i| at -theta_i.
                    let (low, high) = (turned(-theta_i), turned(theta_r));
                    let around = |k: u32| {
                        let cosine = ((f64::from(k) + 0.5) / f64::from(count) * PI).cos();
                        ((low[0] * high[0] + low[1] * high[1] * cosine - 1.0) / variance).exp()
                    };
                    let mean = (0..count).map(around).sum::<f64>() / f64::from(count);
                    // Normalised on the sphere; the circle has TAU of it.
                    let kappa = 1.0 / variance;
                    let expected = TAU * mean * kappa / (TAU * (1.0 - (-2.0 * kappa).exp()));
                    let found = lobe(variance, turned(theta_i), turned(theta_r));
                    assert!((found - expected).abs() < 1e-5 * expected.max(1.0), "{variance}: {found} {expected}");
                }
            }
        }
    }
}
