//! What lies behind the fragments of a pixel that are in order.

use glam::Vec3;

use crate::strands::SectionDraw;

/// What is seen of the fragments behind the `k` nearest of a pixel. AMD's `TAIL` options, one of which drops what is behind
/// too; here the opacity of a tail is always exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Tail {
    /// The mean of their colours, weighted by alpha, with the opacity of all of them.
    #[default]
    Shaded,
    /// The mean of their colours, each weighted by what is seen of it if hair goes on behind the nearest as dense as it is among them, with the
    /// opacity of all of them. Nearer to the truth where hair is dense; lists are gone through once more. Bounded lists have the same picture to
    /// the bit where the device rounds the depths of fragments alike in all kernels.
    Weighted,
    /// The colour of hair without light, with the opacity of all of them: [`Material::base_color`](crate::Material::base_color);
    /// of several sections, their mean, weighted by their segments.
    Unshaded,
    /// Nothing: the opacity of a pixel is that of the `k` nearest.
    None,
}

/// The colour of a tail that is not shaded.
pub(crate) fn unlit(draws: &[SectionDraw]) -> [f32; 4] {
    let segments = |draw: &SectionDraw| draw.segments() as f32;
    let sum: Vec3 = draws.iter().map(|draw| draw.material.colors()[0] * segments(draw)).sum();
    (sum / draws.iter().map(segments).sum::<f32>().max(1.0)).extend(1.0).to_array()
}
