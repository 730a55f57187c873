#![no_main]

use libfuzzer_sys::fuzz_target;
use tressfx_asset::tfxmesh;

fuzz_target!(|data: &[u8]| {
    if let Ok(mesh) = tfxmesh::read("fuzz", data) {
        mesh.check().expect("a reader accepted it");
    }
});
