#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::hair;

fuzz_target!(|data: &[u8]| {
    if let Ok(asset) = hair::read("fuzz", data) {
        tressfx_asset_fuzz::check(&asset);
    }
});
