//! The order of the guides.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg32;

/// The file's strand that each guide is: shuffled, so that any prefix of the guides is an even sample of the groom, or as
/// in the file.
pub(super) fn order(strands: u32, shuffle: bool, seed: u64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..strands).collect();
    if shuffle {
        order.shuffle(&mut Pcg32::seed_from_u64(seed));
    }
    order
}
