//! `hair.render.seen_segments`.

use super::{Fragment, seen_keys};

/// The first vertex of the segment of the fragment that a pixel is seen to have. Of fragments of one depth that of the last segment.
pub fn seen_segments(fragments: &[Fragment]) -> Option<u32> {
    let seen = seen_keys(fragments)?;
    let same = fragments.iter().filter(|fragment| fragment.nearness == seen.nearness);
    same.map(|fragment| fragment.segment).max()
}
