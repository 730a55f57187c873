//! What bad input gets: an error that names file, place and field; never a panic, and never more memory than the bytes
//! that are there justify.

#[path = "support/memory.rs"]
mod memory;
#[path = "support/samples.rs"]
mod samples;

use proptest::prelude::*;
use tressfx_asset::{FileError, FileErrorKind, Report, hair, obj, text, tressfx3, tressfx4};
use tressfx_core::asset::{AssetFormat, AssetProblem, HairAsset, Placement};
use tressfx_core::strands::{StrandOptions, Strands};

type Reader = fn(&str, &[u8]) -> Result<HairAsset, FileError>;

/// Bytes that a reader may allocate at its peak for each byte of the file, and for any file.
const PER_BYTE: usize = 64;
const FLAT: usize = 16 * 1024;

fn reader(format: &str) -> Reader {
    match format {
        "text" => text::read,
        "tressfx3" => tressfx3::read,
        "tressfx4" => tressfx4::read,
        "hair" => hair::read,
        _ => obj::read,
    }
}

/// Reads with the reader of a format and by content, within the memory that is allowed; checks whatever comes out.
fn try_read(format: &str, bytes: &[u8]) -> Result<HairAsset, FileError> {
    let by_content = memory::peak_of(|| drop(tressfx_asset::read_bytes("hostile", bytes)));
    let mut result = None;
    let peak = memory::peak_of(|| result = Some(reader(format)("hostile", bytes))).max(by_content);
    assert!(peak <= FLAT + PER_BYTE * bytes.len(), "{format}: {peak} bytes for a file of {}", bytes.len());
    let result = result.expect("set above");
    match &result {
        Ok(asset) => check(asset),
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains("hostile") && message.contains(&error.field), "{message}");
            // An array that is missing is named by the place where the header says that it is.
            let truncated = matches!(*error.kind, FileErrorKind::Truncated { .. });
            assert!(truncated || error.offset.is_some_and(|offset| offset <= bytes.len() as u64), "{message}");
        }
    }
    result
}

/// What was accepted can be used: for a report, for strands, and for a round trip that keeps every bit.
fn check(asset: &HairAsset) {
    asset.check().expect("a reader accepted it");
    Report::new(asset).expect("a reader accepted it");
    for write in [text::to_bytes, tressfx4::to_bytes] {
        let Ok(written) = write(asset) else { continue };
        let again = tressfx_asset::read_bytes("again", &written).expect("just written");
        assert!(write(&again).expect("just read") == written);
    }
    if let Ok(strands) = Strands::new(asset, &StrandOptions { follows: Some(2), ..StrandOptions::default() }) {
        assert!(strands.rest_of_all().iter().all(|vertex| vertex.is_finite() || vertex.abs().max_element() > 1e38));
        assert!(strands.rest_frames.iter().all(|frame| frame.is_finite()));
        assert!(strands.thickness.iter().all(|thickness| (0.0..=1.0).contains(thickness)));
    }
}

fn all_samples() -> Vec<(&'static str, Vec<u8>)> {
    samples::all().into_iter().flat_map(|(format, files)| files.into_iter().map(move |file| (format, file))).collect()
}

#[test]
fn samples_are_read_by_content() {
    for (format, file) in all_samples() {
        try_read(format, &file).unwrap_or_else(|error| panic!("{format}: {error}"));
        tressfx_asset::read_bytes("named.wrong", &file).unwrap_or_else(|error| panic!("{format}: {error}"));
    }
}

#[test]
fn every_truncation_is_an_error_or_a_sound_asset() {
    for (format, file) in all_samples() {
        for length in 0..file.len() {
            let result = try_read(format, &file[..length]);
            let binary = !matches!(format, "text" | "obj");
            assert!(!binary || result.is_err(), "{format}: {length} of {} bytes were accepted", file.len());
        }
    }
}

#[test]
fn huge_counts_are_refused_at_once() {
    let counts = [("tressfx3", 4..12), ("tressfx4", 4..12), ("hair", 4..12)];
    for (format, region) in counts {
        for (_, file) in all_samples().into_iter().filter(|(name, _)| *name == format) {
            for at in region.clone().step_by(4) {
                for huge in [u32::MAX, 4_000_000_000, 1 << 31, 1 << 24] {
                    let mut file = file.clone();
                    file[at..at + 4].copy_from_slice(&huge.to_le_bytes());
                    let error = try_read(format, &file).expect_err("no such count is in the file");
                    assert!(error.offset.is_some());
                }
            }
        }
    }
    for header in ["numStrands 4000000000\n", "numStrands 1\nstrand 0 numVerts 4000000000\n0 0 0\n"] {
        try_read("text", header.as_bytes()).expect_err("no such count is in the file");
    }
}

#[test]
fn a_small_file_that_claims_billions_of_strands_is_refused() {
    let mut file = samples::tressfx4(1, 2);
    file[4..8].copy_from_slice(&4_000_000_000u32.to_le_bytes());
    let error = try_read("tressfx4", &file).expect_err("far too many strands");
    assert!(matches!(*error.kind, FileErrorKind::Truncated { needed: 128_000_000_000, .. }), "{error}");
}

#[test]
fn non_finite_positions_name_strand_and_vertex() {
    let mut file = samples::tressfx4(2, 3);
    let at = 160 + 16 * 4 + 8;
    file[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = try_read("tressfx4", &file).expect_err("NaN");
    assert!(
        matches!(*error.kind, FileErrorKind::Value(AssetProblem::NotFinite { strand: 1, vertex: 1, .. })),
        "{error}"
    );
    assert_eq!(error.offset, Some(at as u64));

    let text = "numStrands 1\nstrand 0 numVerts 2\n0 0 0\n0 inf 0\n";
    let error = try_read("text", text.as_bytes()).expect_err("infinity");
    assert!(
        matches!(*error.kind, FileErrorKind::Value(AssetProblem::NotFinite { strand: 0, vertex: 1, .. })),
        "{error}"
    );
    assert_eq!((error.line, error.offset), (Some(4), Some(39)));
}

#[test]
fn colours_and_widths_out_of_range_are_named_by_their_place() {
    let spoilt = |format: &'static str, which: usize, at_word: usize, value: f32| {
        let (_, files) = samples::all().into_iter().find(|(name, _)| *name == format).expect("a format");
        let (mut file, at) = (files[which].clone(), 4 * at_word);
        file[at..at + 4].copy_from_slice(&value.to_le_bytes());
        let error = try_read(format, &file).expect_err("out of range");
        assert_eq!(error.offset, Some(at as u64), "{error}");
        error.to_string()
    };
    // The arrays of the samples, as they are laid out there.
    let (last_4, thickness_4) = (samples::tressfx4(2, 3).len() / 4 - 1, 40 + 4 * 6 + 2 * 2 + 2 * 6);
    assert!(spoilt("tressfx4", 0, last_4, 1.5).contains("offsetVertexColor (byte"));
    assert!(spoilt("tressfx4", 0, thickness_4 + 1, -1.0).contains("offsetStrandThickness (byte"));
    assert!(spoilt("tressfx4", 0, last_4 - 3, f32::NAN).contains("offsetVertexColor (byte"));
    assert!(spoilt("tressfx3", 0, 74 + 3 * 6, -0.5).contains("strandThicknessOffset (byte"));
    assert!(spoilt("hair", 1, 6, 1.5).contains("default transparency (byte 24): is 1.5"));
    assert!(spoilt("hair", 1, 9, -0.5).contains("default blue (byte 36): is -0.5"));
}

#[test]
fn colours_and_widths_are_written_where_the_format_holds_them() {
    let read = |format: &'static str, file: &[u8]| try_read(format, file).expect("sound");
    let tfx = read("tressfx4", &samples::tressfx4(2, 3));
    let again = read("tressfx4", &tressfx4::to_bytes(&tfx).expect("written"));
    assert_eq!(
        (again.vertex_colors, again.strand_thickness),
        (tfx.vertex_colors.clone(), tfx.strand_thickness.clone())
    );
    // Transparency becomes the opacity of colours, thickness that is alike along strands that of strands.
    let transparency = vec![0.25; 6];
    let hair = HairAsset {
        vertex_transparency: Some(transparency),
        vertex_thickness: Some(vec![2.0, 2.0, 2.0, 0.5, 0.5, 0.5]),
        strand_thickness: None,
        ..tfx
    };
    assert!(tressfx_asset::dropped_by(&hair, tressfx_asset::WriteFormat::TressFx4).is_empty());
    let again = read("tressfx4", &tressfx4::to_bytes(&hair).expect("written"));
    assert_eq!(again.strand_thickness, Some(vec![2.0, 0.5]));
    let opacities = |asset: &HairAsset| asset.colors().expect("colours").iter().map(|c| c[3]).collect::<Vec<_>>();
    assert_eq!(opacities(&again), opacities(&hair));
    let strands = Strands::new(&again, &StrandOptions { vertices: Some(5), ..StrandOptions::default() });
    let strands = strands.expect("strands");
    let colors = strands.vertex_colors.as_ref().expect("they come along");
    let widths = strands.vertex_widths.as_ref().expect("they come along");
    for (guide, &strand) in strands.order.iter().enumerate() {
        let of_file = &again.vertex_colors.as_ref().expect("colours")[3 * strand as usize..][..3];
        assert_eq!([colors[5 * guide], colors[5 * guide + 4]].map(|color| color.to_array()), [of_file[0], of_file[2]]);
        assert!(widths[5 * guide..][..5].iter().all(|&width| width == [2.0, 0.5][strand as usize]));
    }
    let pose = strands.pose_asset(&strands.rest, false).expect("a pose");
    assert_eq!(pose.strand_widths().expect("alike").to_vec(), [2.0, 0.5]);
}

#[test]
fn files_of_other_kinds_are_no_grooms() {
    for bytes in [&b""[..], b"\x89PNG\r\n\x1a\n", b"hello world, this is a letter", b"{\"asset\": {}}", &[0; 400]] {
        let error = tressfx_asset::read_bytes("hostile", bytes).expect_err("no groom");
        assert!(matches!(*error.kind, FileErrorKind::UnknownFormat), "{error}");
    }
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        for format in ["text", "tressfx3", "tressfx4", "hair", "obj"] {
            let _ = try_read(format, &bytes);
        }
    }

    #[test]
    fn mutated_files_never_panic(
        choice in any::<prop::sample::Index>(),
        edits in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in proptest::option::of(any::<prop::sample::Index>()),
    ) {
        let samples = all_samples();
        let (format, mut file) = choice.get(&samples).clone();
        for (at, byte) in &edits {
            let at = at.index(file.len());
            file[at] = *byte;
        }
        if let Some(cut) = cut {
            file.truncate(cut.index(file.len()));
        }
        let _ = try_read(format, &file);
    }

    #[test]
    fn written_grooms_come_back_to_the_bit(
        strands in proptest::collection::vec(proptest::collection::vec(finite_point(), 1..9), 1..9),
        version_2 in any::<bool>(),
    ) {
        let counts = strands.iter().map(|strand| strand.len() as u32).collect();
        let mut groom = HairAsset::new("groom", AssetFormat::Text, strands.concat(), counts);
        if version_2 {
            groom.version = Some(2.0);
            groom.placement = Some(Placement { scale: 0.1, ..Default::default() });
            groom.follow_count = Some(3);
        }
        let written = text::to_bytes(&groom).expect("sound");
        let again = tressfx_asset::read_bytes("groom", &written).expect("just written");
        prop_assert_eq!(&again, &groom);
        let bits = |groom: &HairAsset| groom.points.as_flattened().iter().map(|c| c.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&again), bits(&groom));
    }
}

/// Any finite bits, -0.0 and subnormal numbers too.
fn finite_point() -> impl Strategy<Value = [f32; 3]> {
    let coordinate = any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |c| c.is_finite());
    [coordinate.clone(), coordinate.clone(), coordinate]
}
