//! `hair.render.shortcut_colors`.

use super::{Fragment, LayerPlace, Layers};

/// The fragments of a pixel that give it its colour, in the order of their places: those that are not behind the last of `k`
/// layers.
pub fn shortcut_colors(fragments: &[Fragment], layers: &Layers, k: usize) -> Vec<Fragment> {
    let last = layers.places.get(k - 1);
    let is_in_front = |fragment: &&Fragment| last.is_none_or(|last| LayerPlace::new(fragment) <= *last);
    let mut front: Vec<_> = fragments.iter().filter(is_in_front).copied().collect();
    front.sort_by(|a, b| LayerPlace::new(a).partial_cmp(&LayerPlace::new(b)).expect("depths are numbers"));
    front
}
