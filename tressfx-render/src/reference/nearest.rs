//! `hair.render.nearest`.

use super::Fragment;

/// The nearness of the last of the `kept` nearest fragments of a pixel: those that are no farther are kept. None where there are no
/// more than that, and all are.
pub fn nearest(fragments: &[Fragment], kept: usize) -> Option<f64> {
    let mut nearness: Vec<f64> = fragments.iter().map(|fragment| fragment.nearness).collect();
    nearness.sort_by(|a, b| b.total_cmp(a));
    if nearness.len() > kept { nearness.get(kept.wrapping_sub(1)).copied().or(Some(f64::INFINITY)) } else { None }
}
