#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::obj;

fuzz_target!(|data: &[u8]| {
    if let Ok(asset) = obj::read("fuzz", data) {
        tressfx_asset_fuzz::check(&asset);
    }
});
