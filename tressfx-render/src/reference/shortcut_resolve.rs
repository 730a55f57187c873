//! `hair.render.shortcut_resolve`.

use glam::{DVec3, DVec4};

use super::{Fragment, Layers};

/// The colour of a pixel, premultiplied, and its alpha: that of all its fragments. The colour is that of those in front, as
/// their mean weighted by alpha, or in order, with the mean behind them.
pub fn shortcut_resolve(front: &[Fragment], layers: &Layers, ordered: bool) -> DVec4 {
    let weight: f64 = front.iter().map(|fragment| fragment.alpha).sum();
    if weight == 0.0 {
        return DVec4::ZERO;
    }
    let mean = front.iter().map(|fragment| fragment.alpha * fragment.color).sum::<DVec3>() / weight;
    let (mut color, mut transmittance) = (DVec3::ZERO, 1.0);
    for fragment in front.iter().filter(|_| ordered) {
        color += transmittance * fragment.alpha * fragment.color;
        transmittance *= 1.0 - fragment.alpha;
    }
    color += (transmittance - layers.transmittance) * mean;
    color.extend(1.0 - layers.transmittance)
}
