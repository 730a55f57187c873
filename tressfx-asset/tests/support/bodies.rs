//! Small valid files of what moves hair: tests change them, and the fuzz targets start from them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use tressfx_asset::pc2::{self, PointCache};
use tressfx_core::glam::Vec3;

/// A format's name and its samples.
pub(crate) fn all() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    vec![
        ("gltf", vec![small_gltf().into_bytes(), small_glb()]),
        ("tfxbone", vec![small_bones()]),
        ("tfxmesh", vec![SMALL_MESH.into()]),
        ("tfxskin", vec![small_skin()]),
        ("pc2", vec![small_cache()]),
    ]
}

/// A point cache of two points.
fn small_cache() -> Vec<u8> {
    let cache = PointCache { points: 2, start_frame: 0.0, sample_rate: 0.5, positions: vec![Vec3::ONE; 6] };
    pc2::to_bytes("cache", &cache).expect("the counts fit")
}

/// The glTF below as `.glb`, with a binary chunk that nothing uses.
fn small_glb() -> Vec<u8> {
    let mut json = small_gltf().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    let lengths = [2, 12 + 8 + json.len() + 8 + 4, json.len()];
    file.extend(lengths.iter().flat_map(|&length| (length as u32).to_le_bytes()));
    file.extend(b"JSON");
    file.extend(json);
    file.extend(4u32.to_le_bytes());
    file.extend(b"BIN\0");
    file.extend([0; 4]);
    file
}

/// A `.tfxbone` of two bones and one strand.
pub(crate) fn small_bones() -> Vec<u8> {
    let mut out = 2i32.to_le_bytes().to_vec();
    for (index, name) in [(0i32, b"hips\0"), (1, b"head\0")] {
        out.extend(index.to_le_bytes());
        out.extend(5i32.to_le_bytes());
        out.extend(name);
    }
    out.extend(1i32.to_le_bytes());
    out.extend(0i32.to_le_bytes());
    for (bone, weight) in [(1i32, 0.5f32), (0, 0.25), (0, 0.0), (0, 0.0)] {
        out.extend(bone.to_le_bytes());
        out.extend(weight.to_le_bytes());
    }
    out
}

/// A `.tfxskin` of one strand.
pub(crate) fn small_skin() -> Vec<u8> {
    let mut out = vec![0; 268 + 24];
    let mut put = |at: usize, bytes: [u8; 4]| out[at..at + 4].copy_from_slice(&bytes);
    put(0, 1u32.to_le_bytes());
    put(4, 1u32.to_le_bytes());
    put(136, 268u32.to_le_bytes());
    put(268 + 4, 7u32.to_le_bytes());
    put(268 + 8, 0.25f32.to_le_bytes());
    put(268 + 16, 0.75f32.to_le_bytes());
    out
}

/// A `.tfxmesh` of a triangle with one bone.
pub(crate) const SMALL_MESH: &str = "# mesh\r\nnumOfBones 1\r\n0 root\r\nnumOfVertices 3\r\n0 0 0 0 0 0 1 0 0 0 0 1 0 0 0\r\n\
                          1 1 0 0 0 0 1 0 0 0 0 0.5 0 0 0\r\n2 0 1 0 0 0 1 0 0 0 0 1 0 0 0\r\nnumOfTriangles 1\r\n0 0 1 2\r\n";

/// A triangle with two joints, one below a node that enlarges a hundred times, texture coordinates, tangents (the numbers of the weights), a morph target and an animation of all properties.
pub(crate) fn small_gltf() -> String {
    let mut data = Vec::new();
    let mut views = Vec::new();
    let mut put = |values: &[f32]| {
        views.push(format!(r#"{{"buffer":0,"byteOffset":{},"byteLength":{}}}"#, data.len(), 4 * values.len()));
        data.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    };
    put(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    put(&[0.5, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    put(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
    put(&[0.0, 1.0]);
    put(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    put(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    put(&[0.0, 1.0]);
    put(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let joints = data.len();
    data.extend([0u8, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    views.push(format!(r#"{{"buffer":0,"byteOffset":{joints},"byteLength":12}}"#));
    let uri = STANDARD.encode(&data);
    let accessor = |view: usize, count: usize, kind: &str, component: u32| {
        let range = if view == 0 { r#","min":[0,0,0],"max":[1,1,0]"# } else { "" };
        format!(r#"{{"bufferView":{view},"count":{count},"type":"{kind}","componentType":{component}{range}}}"#)
    };
    let accessors = [
        accessor(0, 3, "VEC3", 5126),
        accessor(1, 3, "VEC4", 5126),
        accessor(2, 3, "VEC3", 5126),
        accessor(3, 2, "SCALAR", 5126),
        accessor(4, 2, "VEC4", 5126),
        accessor(5, 6, "VEC3", 5126),
        accessor(6, 2, "SCALAR", 5126),
        accessor(8, 3, "VEC4", 5121),
        accessor(7, 3, "VEC2", 5126),
    ];
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{uri}"}}],
"bufferViews":[{}],"accessors":[{}],
"nodes":[{{"name":"big","scale":[100,100,100],"children":[1]}},{{"name":"tip"}},{{"mesh":0,"skin":0}}],
"skins":[{{"joints":[0,1]}}],
"meshes":[{{"weights":[0.5],"primitives":[{{"attributes":{{"POSITION":0,"WEIGHTS_0":1,"JOINTS_0":7,"TEXCOORD_0":8,"TANGENT":1}},"targets":[{{"POSITION":2}}]}}]}}],
"animations":[{{"name":"all","samplers":[{{"input":3,"output":4}},{{"input":3,"output":5,"interpolation":"CUBICSPLINE"}},{{"input":3,"output":6,"interpolation":"STEP"}}],
"channels":[{{"sampler":0,"target":{{"node":1,"path":"rotation"}}}},{{"sampler":1,"target":{{"node":1,"path":"translation"}}}},{{"sampler":2,"target":{{"node":2,"path":"weights"}}}}]}}]}}"#,
        data.len(),
        views.join(","),
        accessors.join(",")
    )
}
