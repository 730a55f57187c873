//! Real grooms against counts that an independent parser found. They are no part of the repository: the folder that holds
//! them is named by the environment variable TRESSFX_ASSETS. Without it these tests count as ignored.

#[path = "support/assets.rs"]
mod assets;

use assets::folder;
use tressfx_asset::{Report, text, tressfx4};
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::strands::{StrandOptions, Strands};

/// What is known about a file: path, format, strands, vertices, then length (min, mean, max).
struct Known {
    path: &'static str,
    format: AssetFormat,
    strands: usize,
    vertices: usize,
    length: [f64; 3],
    metres_per_unit: f32,
}

const MOHAWK: &str = "tressfx41_ratboy/Ratboy_mohawk.tfx";
const SINTEL: &str = "sintel_lite/GEO-sintel_hair_emit.002-sintel_hair.tfx";
const SHORT_FUR: &str = "tressfx31_testhair1/TestHair1.tfx";

const KNOWN: [Known; 6] = [
    Known {
        path: MOHAWK,
        format: AssetFormat::TressFx4,
        strands: 2228,
        vertices: 71296,
        length: [7.493e-6, 0.1033, 0.295],
        metres_per_unit: 1.0,
    },
    Known {
        path: SINTEL,
        format: AssetFormat::TressFx4,
        strands: 228,
        vertices: 7296,
        length: [5.07, 15.02, 28.65],
        metres_per_unit: 0.01,
    },
    Known {
        path: SHORT_FUR,
        format: AssetFormat::TressFx3,
        strands: 10027,
        vertices: 40108,
        length: [11.0, 11.0, 11.0],
        metres_per_unit: 0.001,
    },
    Known {
        path: "fibermesh_text_tfx/Fibermesh2_mohi0.3k_Curves.tfx",
        format: AssetFormat::Text,
        strands: 300,
        vertices: 1200,
        length: [6.137, 51.62, 113.2],
        metres_per_unit: 0.001,
    },
    Known {
        path: "fibermesh_text_tfx/Fibermesh2_hair1k_Curves.tfx",
        format: AssetFormat::Text,
        strands: 1000,
        vertices: 6000,
        length: [6.368, 37.04, 69.48],
        metres_per_unit: 0.001,
    },
    Known {
        path: "unity_cube_hair_obj/Cube_Hair.obj",
        format: AssetFormat::Obj,
        strands: 1000,
        vertices: 5000,
        length: [4.0, 4.0, 4.0],
        metres_per_unit: 0.01,
    },
];

/// The asset and its bytes.
fn load(folder: &std::path::Path, path: &str) -> (HairAsset, Vec<u8>) {
    let path = folder.join(path);
    let bytes = std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    (tressfx_asset::read(&path).unwrap_or_else(|error| panic!("{error}")), bytes)
}

fn report_of(asset: &HairAsset) -> Report {
    Report::new(asset).unwrap_or_else(|error| panic!("{error}"))
}

/// Equal to the four digits that are known.
fn nearly(found: f64, known: f64) -> bool {
    (found - known).abs() <= 5.1e-4 * known.abs()
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn counts_and_lengths_are_the_known_ones() {
    let folder = folder();
    for known in &KNOWN {
        let report = report_of(&load(&folder, known.path).0);
        assert_eq!(report.format, known.format, "{}", known.path);
        assert_eq!((report.strands, report.vertices), (known.strands, known.vertices), "{}", known.path);
        assert_eq!(report.metres_per_unit, known.metres_per_unit, "{}", known.path);
        let [min, mean, max] = known.length;
        let found = report.length;
        assert!(
            nearly(found.min, min) && nearly(found.mean, mean) && nearly(found.max, max),
            "{}: {found:?}",
            known.path
        );
    }
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn oddities_and_pins_are_the_known_ones() {
    let folder = folder();
    let mohawk = load(&folder, MOHAWK).0;
    let report = report_of(&mohawk);
    assert_eq!((report.oddities.zero_length_segments, report.oddities.zero_length_strands), (31, 1));
    assert_eq!(report.pinned_vertices, 2 * 2228);
    assert_eq!(report.arrays, ["inverse mass", "strand UVs"]);
    let uvs = mohawk.strand_uvs.expect("the mohawk has strand UVs");
    let (min, max) = uvs.as_flattened().iter().fold((1.0f32, 0.0f32), |(min, max), &c| (min.min(c), max.max(c)));
    assert!(nearly(min.into(), 0.00499) && nearly(max.into(), 0.774), "{min} {max}");

    let sintel = report_of(&load(&folder, SINTEL).0);
    assert_eq!(sintel.pinned_vertices, 228);
    assert_eq!(sintel.arrays, ["inverse mass"]);
    assert!(sintel.oddities.is_empty());

    let mohi = load(&folder, "fibermesh_text_tfx/Fibermesh2_mohi0.3k_Curves.tfx").0;
    assert_eq!((mohi.follow_count, mohi.follow_radius, mohi.max_vertices), (Some(4), Some(1.5), Some(4)));
    assert_eq!((mohi.sorted, mohi.version), (Some(true), Some(2.0)));
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn binary_files_are_written_back_byte_for_byte() {
    let folder = folder();
    for path in [MOHAWK, SINTEL] {
        let (asset, bytes) = load(&folder, path);
        assert!(tressfx4::to_bytes(&asset).expect("one vertex count") == bytes, "{path}");
    }
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn round_trips_through_both_formats_keep_every_bit() {
    let folder = folder();
    for known in &KNOWN {
        let asset = load(&folder, known.path).0;
        let bits = |points: &[[f32; 3]]| points.as_flattened().iter().map(|c| c.to_bits()).collect::<Vec<_>>();
        for bytes in [text::to_bytes(&asset), tressfx4::to_bytes(&asset)] {
            let again = tressfx_asset::read_bytes("again", &bytes.expect("one vertex count")).expect("just written");
            assert_eq!(again.counts, asset.counts, "{}", known.path);
            assert!(bits(&again.points) == bits(&asset.points), "{}", known.path);
            assert_eq!(again.strand_uvs.is_some(), asset.strand_uvs.is_some());
        }
    }
}

#[test]
#[ignore = "reads the folder that TRESSFX_ASSETS names"]
fn strands_are_finite_and_the_pose_goes_back_in_file_order() {
    let folder = folder();
    for known in &KNOWN {
        let asset = load(&folder, known.path).0;
        let strands = Strands::new(&asset, &StrandOptions::default()).expect("a real groom");
        assert_eq!(strands.guides as usize, known.strands);
        let all = strands.rest_of_all();
        assert_eq!(all.len(), (strands.strand_count() * strands.vertices) as usize);
        assert!(all.iter().all(|position| position.is_finite()));
        assert!(strands.rest_frames.iter().all(|frame| frame.is_finite() && frame.is_normalized()));
        assert!(strands.tangents.iter().all(|tangent| (tangent.length() - 1.0).abs() < 1e-6));
        assert!(strands.thickness.iter().all(|thickness| (0.0..=1.0).contains(thickness)));
        let pose = strands.pose_asset(&strands.rest, false).expect("as many as the guides have");
        assert_eq!(pose.points, asset.points);
        assert_eq!(pose.strand_uvs, asset.strand_uvs);
        assert_eq!(pose.inverse_mass.as_deref(), Some(&*asset.inverse_masses()));
    }
}
