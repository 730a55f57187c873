#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_core::asset::tressfx4;

fuzz_target!(|data: &[u8]| {
    if let Ok(asset) = tressfx4::read("fuzz", data) {
        tressfx_core_fuzz::check(&asset);
    }
});
