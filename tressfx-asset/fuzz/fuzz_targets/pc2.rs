#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::pc2;

fuzz_target!(|data: &[u8]| {
    if let Ok(cache) = pc2::read("fuzz", data) {
        let written = pc2::to_bytes("fuzz", &cache).expect("just read");
        assert!(pc2::read("again", &written).expect("just written") == cache);
        assert_eq!(cache.at(0.5).len(), cache.points);
    }
});
