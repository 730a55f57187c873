#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::text;

fuzz_target!(|data: &[u8]| {
    if let Ok(asset) = text::read("fuzz", data) {
        tressfx_asset_fuzz::check(&asset);
    }
});
