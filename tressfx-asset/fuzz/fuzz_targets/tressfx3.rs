#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::tressfx3;

fuzz_target!(|data: &[u8]| {
    if let Ok(asset) = tressfx3::read("fuzz", data) {
        tressfx_asset_fuzz::check(&asset);
    }
});
