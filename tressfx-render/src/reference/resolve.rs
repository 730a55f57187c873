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
    let weight: f64 = rest.iter().map(|fragment| fragment.alpha).sum();
    if weight > 0.0 && tail != Tail::None {
        let average = rest.iter().map(|fragment| fragment.alpha * fragment.color).sum::<DVec3>() / weight;
        let passed: f64 = rest.iter().map(|fragment| 1.0 - fragment.alpha).product();
        front.take(if tail == Tail::Shaded { average } else { unlit }, &vec![1.0 - passed; places as usize]);
    }
    front.color.extend(1.0 - front.passes())
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
