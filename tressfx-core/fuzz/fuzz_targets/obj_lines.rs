#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_core::asset::obj_lines;

fuzz_target!(|data: &[u8]| {
    if let Ok(asset) = obj_lines::read("fuzz", data) {
        tressfx_core_fuzz::check(&asset);
    }
});
