//! `hair.render.resolve`.

use glam::{DVec3, DVec4};

use super::Fragment;

/// The colour of a pixel, premultiplied, and its alpha: the `k` nearest of its fragments in order, behind them the average
/// colour of the rest with its true opacity. With `k` not below the number of fragments that is the exact result.
pub fn resolve(fragments: &mut [Fragment], k: usize) -> DVec4 {
    fragments.sort_by(|a, b| b.nearness.total_cmp(&a.nearness));
    let (nearest, rest) = fragments.split_at(k.min(fragments.len()));
    let (mut color, mut transmittance) = (DVec3::ZERO, 1.0);
    for fragment in nearest {
        color += transmittance * fragment.alpha * fragment.color;
        transmittance *= 1.0 - fragment.alpha;
    }
    let weight: f64 = rest.iter().map(|fragment| fragment.alpha).sum();
    if weight > 0.0 {
        let average = rest.iter().map(|fragment| fragment.alpha * fragment.color).sum::<DVec3>() / weight;
        let behind = rest.iter().fold(transmittance, |left, fragment| left * (1.0 - fragment.alpha));
        color += (transmittance - behind) * average;
        transmittance = behind;
    }
    color.extend(1.0 - transmittance)
}
