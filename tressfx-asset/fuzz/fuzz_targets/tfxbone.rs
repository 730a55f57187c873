#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::bones;

fuzz_target!(|data: &[u8]| {
    if let Ok(read) = bones::read("fuzz", data) {
        let bones = read.bones.len() as u32;
        assert!(read.strands.iter().all(|of| of.joints.iter().all(|&joint| joint < bones)));
    }
});
