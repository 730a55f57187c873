//! `hair.render.seen_keys`.

use super::Fragment;

/// Below this alpha a fragment counts only where all others of its pixel are as faint.
const FAINT: f64 = 0.02;

/// Of the fragments of a pixel the one that it is seen to have: the nearest that is not faint, or the nearest of all. None where there is no
/// fragment.
pub fn seen_keys(fragments: &[Fragment]) -> Option<&Fragment> {
    let key = |fragment: &Fragment| (fragment.alpha >= FAINT, fragment.nearness);
    fragments.iter().max_by(|a, b| {
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    })
}
