#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::tfxskin;

fuzz_target!(|data: &[u8]| {
    if let Ok(read) = tfxskin::read("fuzz", data) {
        assert!(read.roots.iter().all(|root| root.barycentric.iter().all(|share| share.is_finite())));
    }
});
