//! `hair.render.resolve`.

use glam::{DVec3, DVec4};

use super::Fragment;
use crate::ppll::Tail;

/// The colour of a pixel, premultiplied, and its alpha: the `k` nearest of its fragments in order, behind them the average
/// colour of the rest with its true opacity. With `k` not below the number of fragments that is the exact result.
pub fn resolve(fragments: &mut [Fragment], k: usize) -> DVec4 {
    resolve_with_tail(fragments, k, Tail::Shaded, DVec3::ZERO)
}

/// The same with something else behind the `k` nearest; `unlit` is the colour of a tail that is not shaded.
pub fn resolve_with_tail(fragments: &mut [Fragment], k: usize, tail: Tail, unlit: DVec3) -> DVec4 {
    fragments.sort_by(|a, b| b.nearness.total_cmp(&a.nearness));
    let (nearest, rest) = fragments.split_at(k.min(fragments.len()));
    let (mut color, mut transmittance) = (DVec3::ZERO, 1.0);
    for fragment in nearest {
        color += transmittance * fragment.alpha * fragment.color;
        transmittance *= 1.0 - fragment.alpha;
    }
    let weight: f64 = rest.iter().map(|fragment| fragment.alpha).sum();
    if weight > 0.0 && tail != Tail::None {
        let average = rest.iter().map(|fragment| fragment.alpha * fragment.color).sum::<DVec3>() / weight;
        let behind = rest.iter().fold(transmittance, |left, fragment| left * (1.0 - fragment.alpha));
        color += (transmittance - behind) * if tail == Tail::Shaded { average } else { unlit };
        transmittance = behind;
    }
    color.extend(1.0 - transmittance)
}

/// The same with all fragments in order, where light passes so many places of the pixel for themselves, 4 or 16.
///
/// # Panics
/// If there are others.
pub fn resolve_at_places(fragments: &mut [Fragment], places: u32) -> DVec4 {
    fragments.sort_by(|a, b| b.nearness.total_cmp(&a.nearness));
    let mut color = DVec3::ZERO;
    let mut transmittance = vec![1.0; places as usize];
    let mean = |all: &[f64]| all.iter().sum::<f64>() / f64::from(places);
    for fragment in fragments {
        let before = mean(&transmittance);
        for (left, share) in transmittance.iter_mut().zip(fragment.stripe.shares(places)) {
            *left *= 1.0 - (share * fragment.opacity).clamp(0.0, 1.0);
        }
        color += (before - mean(&transmittance)) * fragment.color;
    }
    color.extend(1.0 - mean(&transmittance))
}
