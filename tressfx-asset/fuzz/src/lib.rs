//! What must hold for every asset that a reader accepts, whatever the bytes were.
//!
//! There is a target for each reader. In this folder, with a nightly compiler (or RUSTC_BOOTSTRAP=1) and cargo-fuzz:
//! `cargo run --example seeds`, then `cargo fuzz run text -s none -- -max_total_time=600 -max_len=4096`.

use tressfx_asset::{FileError, Report, read_bytes, text, tressfx4};
use tressfx_core::asset::HairAsset;
use tressfx_core::strands::{StrandOptions, Strands};

/// Strands are made only of assets up to this many points, so that the fuzzer spends its time in the readers.
const FEW_POINTS: usize = 1000;

/// Checks an asset that a reader accepted: it is sound, a report and strands can be made of it, and it goes through both
/// written formats without losing a bit.
pub fn check(asset: &HairAsset) {
    asset.check().expect("a reader accepted it");
    Report::new(asset).expect("a reader accepted it");
    round_trip(asset, text::to_bytes);
    if asset.uniform_count().is_some() {
        round_trip(asset, tressfx4::to_bytes);
    }
    if asset.points.len() <= FEW_POINTS {
        strands(asset);
    }
}

/// Written, read and written again gives the same bytes; what cannot be written is refused with an error.
fn round_trip(asset: &HairAsset, write: fn(&HairAsset) -> Result<Vec<u8>, FileError>) {
    let Ok(written) = write(asset) else { return };
    let again = read_bytes(&asset.name, &written).expect("just written");
    assert_eq!(again.counts, asset.counts);
    assert!(write(&again).expect("just read") == written);
}

/// Strands are finite, or refused with an error.
fn strands(asset: &HairAsset) {
    let options = StrandOptions { follows: Some(1), ..StrandOptions::default() };
    let Ok(strands) = Strands::new(asset, &options) else { return };
    assert!(strands.rest.iter().all(|vertex| vertex.is_finite()));
    assert!(strands.rest_lengths.iter().all(|length| length.is_finite()));
    assert!(strands.rest_frames.iter().all(|frame| frame.is_finite()));
    assert!(strands.tangents.iter().all(|tangent| tangent.is_finite()));
    assert!(strands.thickness.iter().all(|thickness| (0.0..=1.0).contains(thickness)));
}
