//! `hair.render.shortcut_depths`.

use super::Fragment;

/// The layers of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// The places of the fragments that have a layer, the first ones first: as many as there are layers, or fewer. One that is
    /// opaque has all layers from its own on.
    pub places: Vec<LayerPlace>,
    /// The share of light that passes through all fragments.
    pub transmittance: f64,
}

/// Where among the layers a fragment belongs: what is faint comes last, then the nearest comes first.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct LayerPlace {
    /// Whether its alpha is below 0.02.
    pub is_faint: bool,
    /// How far it is: more is farther.
    pub farness: f64,
}

impl LayerPlace {
    /// The place of a fragment.
    pub fn new(fragment: &Fragment) -> Self {
        Self { is_faint: (fragment.alpha * 65535.0).round() < 1311.0, farness: -fragment.nearness }
    }
}

/// The places of the first `k` fragments of a pixel, and the opacity of all.
pub fn shortcut_depths(fragments: &[Fragment], k: usize) -> Layers {
    let sorted = |fragments: &mut dyn Iterator<Item = &Fragment>| {
        let mut places: Vec<_> = fragments.map(LayerPlace::new).collect();
        places.sort_by(|a, b| a.partial_cmp(b).expect("depths are numbers"));
        places
    };
    let mut places = sorted(&mut fragments.iter());
    let opaque = sorted(&mut fragments.iter().filter(|fragment| (fragment.alpha * 65535.0).round() == 65535.0));
    if let Some(&wall) = opaque.first() {
        places.retain(|&place| place <= wall);
        places.resize(places.len().max(k), wall);
    }
    places.truncate(k);
    Layers { places, transmittance: fragments.iter().map(|fragment| 1.0 - fragment.alpha).product() }
}
