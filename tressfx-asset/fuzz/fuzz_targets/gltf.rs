#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::character::read_bytes;

fuzz_target!(|data: &[u8]| {
    if let Ok(character) = read_bytes("fuzz", data, None) {
        character.mesh.check().expect("a reader accepted it");
        for animation in &character.animations {
            let pose = character.pose(Some(animation), 0.4 * animation.seconds);
            assert_eq!(pose.joints.len(), character.mesh.joints.len());
        }
    }
});
