//! `hair.render.resolve`.

use glam::{DVec3, DVec4};

use super::Fragment;
use crate::ppll::Tail;

/// The colour of a pixel, premultiplied, and its alpha: the `k` nearest of its fragments in order, behind them the average
/// colour of the rest with its true opacity. With `k` not below the number of fragments that is the exact result.
pub fn resolve(fragments: &mut [Fragment], k: usize) -> DVec4 {
    resolve_at_places(fragments, k, 1)
}

/// The same where light passes so many places of the pixel for themselves.
///
/// # Panics
/// If there are others than 1, 4, 16 or 64.
pub fn resolve_at_places(fragments: &mut [Fragment], k: usize, places: u32) -> DVec4 {
    resolve_with_tail(fragments, k, places, Tail::Shaded, DVec3::ZERO)
}

/// The same with something else behind the `k` nearest, which covers all places alike; `unlit` is the colour of a tail that is not shaded.
///
/// # Panics
/// If there are others than 1, 4, 16 or 64 places.
pub fn resolve_with_tail(fragments: &mut [Fragment], k: usize, places: u32, tail: Tail, unlit: DVec3) -> DVec4 {
    fragments.sort_by(|a, b| b.nearness.total_cmp(&a.nearness));
    let (nearest, rest) = fragments.split_at(k.min(fragments.len()));
    let mut front = Front { color: DVec3::ZERO, transmittance: vec![1.0; places as usize] };
    for fragment in nearest {
        front.take(fragment.color, &fragment.stripe.parts(places, fragment.alpha));
    }
    let weights: Vec<f64> = rest.iter().map(|fragment| weight(nearest, fragment, tail)).collect();
    let sum: f64 = weights.iter().sum();
    if sum > 0.0 && tail != Tail::None {
        let average = rest.iter().zip(&weights).map(|(fragment, weight)| *weight * fragment.color).sum::<DVec3>() / sum;
        let passed: f64 = rest.iter().map(|fragment| 1.0 - fragment.alpha).product();
        front.take(if tail == Tail::Unshaded { unlit } else { average }, &vec![1.0 - passed; places as usize]);
    }
    front.color.extend(1.0 - front.passes())
}

/// The nearest fragments are taken to be at least this share of their nearness apart: of what is closer rounding in `f32` is too
/// large a part.
const THINNEST: f64 = 1e-6;

/// No weight is less unless alpha is.
const LEAST_WEIGHT: f64 = 32.0 / 65535.0;

/// With which weight a fragment of a tail counts in its colour.
///
/// What lies deep in a tail is seen less than what lies at its beginning. How much less is not known without order, but about: behind the nearest
/// fragments hair goes on as dense as it is among them, and each layer stops as much light as this fragment does. How dense hair is has an error
/// of its own, since the nearest are few: what is seen is the mean over all densities that so many fragments may come from (a gamma distribution).
fn weight(nearest: &[Fragment], fragment: &Fragment, tail: Tail) -> f64 {
    let (Tail::Weighted, [first, .., last]) = (tail, nearest) else { return fragment.alpha };
    let thick = (first.nearness - last.nearness).max(THINNEST * first.nearness).max(1e-30);
    let layer = thick / (nearest.len() - 1) as f64;
    let layers = (last.nearness - fragment.nearness).max(0.0) / layer;
    let (depth, count) = (-(1.0 - fragment.alpha).max(1.0 / 65535.0).ln() * layers, nearest.len() as f64);
    (fragment.alpha * (1.0 + depth / count).powf(-count)).max(fragment.alpha.min(LEAST_WEIGHT))
}

/// What lies before the hair that comes next.
struct Front {
    color: DVec3,
    /// Of each place in the pixel.
    transmittance: Vec<f64>,
}

impl Front {
    /// How much of what is behind is seen.
    fn passes(&self) -> f64 {
        self.transmittance.iter().sum::<f64>() / self.transmittance.len() as f64
    }

    /// Takes what comes next: a colour, and its opacity at each place.
    fn take(&mut self, color: DVec3, parts: &[f64]) {
        let before = self.passes();
        for (left, part) in self.transmittance.iter_mut().zip(parts) {
            *left *= 1.0 - part;
        }
        self.color += (before - self.passes()) * color;
    }
}
