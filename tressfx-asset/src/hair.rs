//! `.hair`, the format of Cem Yuksel's hair models (<http://www.cemyuksel.com/research/hairmodels>): a header of 128 bytes,
//! then those of five arrays whose bits are set, in this order.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | u8 x 4 | "HAIR" |
//! | 4 | u32 | strands |
//! | 8 | u32 | points of all strands |
//! | 12 | u32 | bits: 0 segments, 1 points, 2 thickness, 3 transparency, 4 colour |
//! | 16 | u32 | default segments |
//! | 20 | f32 | default thickness |
//! | 24 | f32 | default transparency |
//! | 28 | f32 x 3 | default colour |
//! | 40 | u8 x 88 | info |
//!
//! segments: u16 per strand, which has one point more; points: f32 x 3; thickness: f32 per point; transparency: f32 per
//! point; colour: f32 x 3 per point. All little-endian.

use tressfx_core::asset::{AssetFormat, AssetProblem, Domain, HairAsset, HairDefaults, Values};

use crate::binary::{Bytes, scalars};
use crate::{FileError, FileErrorKind};

/// The first four bytes of the file.
pub(crate) const MAGIC: [u8; 4] = *b"HAIR";
const HEADER: usize = 128;
const INFO: usize = 40;

const SEGMENTS: u32 = 1 << 0;
const POINTS: u32 = 1 << 1;
const THICKNESS: u32 = 1 << 2;
const TRANSPARENCY: u32 = 1 << 3;
const COLOR: u32 = 1 << 4;

/// Reads a `.hair` file. A strand of 0 segments is one of a single point. Bytes behind the last array are ignored.
///
/// # Errors
/// Where an array is not in the file, the points are absent, a bit is set that the format does not know, the segments do
/// not add up to the points, a value is not finite, a thickness is negative, or a colour or a transparency is not from 0 to 1.
pub fn read(name: &str, data: &[u8]) -> Result<HairAsset, FileError> {
    let bytes = Bytes { name, data };
    bytes.slice("header", 0, 1, HEADER as u64)?;
    if !data.starts_with(&MAGIC) {
        let found = String::from_utf8_lossy(&data[..MAGIC.len()]).into_owned();
        return Err(bytes.error("magic", 0, FileErrorKind::Unexpected { found, expected: "HAIR" }));
    }
    let bits = array_bits(bytes)?;
    let defaults = defaults(bytes)?;
    let mut at = HEADER;
    let counts = counts(bytes, bits, defaults.segments, &mut at)?;
    let mut arrays = Arrays { bytes, bits, at, counts: &counts };
    let points = arrays.next(POINTS, "points", Values::Any)?.unwrap_or_default();
    let vertex_thickness = arrays.next(THICKNESS, "thickness", Values::NotNegative)?.map(scalars);
    let vertex_transparency = arrays.next(TRANSPARENCY, "transparency", Values::Share)?.map(scalars);
    let colors: Option<Vec<[f32; 3]>> = arrays.next(COLOR, "colour", Values::Share)?;
    Ok(HairAsset {
        vertex_thickness,
        vertex_transparency,
        vertex_colors: colors.map(|colors| colors.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()),
        hair_defaults: Some(defaults),
        ..HairAsset::new(name, AssetFormat::Hair, points, counts)
    })
}

fn array_bits(bytes: Bytes<'_>) -> Result<u32, FileError> {
    let bits = bytes.u32("arrays", 12)?;
    let known = SEGMENTS | POINTS | THICKNESS | TRANSPARENCY | COLOR;
    if bits & POINTS == 0 || bits & !known != 0 {
        let expected = "bits 0 to 4 only, with bit 1 (points) set";
        return Err(bytes.error("arrays", 12, AssetProblem::out_of_range(format!("{bits:#x}"), expected)));
    }
    Ok(bits)
}

fn defaults(bytes: Bytes<'_>) -> Result<HairDefaults, FileError> {
    let share = |field, offset| bytes.f32_in(field, offset, Values::Share);
    let mut info = [0; HEADER - INFO];
    info.copy_from_slice(bytes.slice("info", INFO, 1, (HEADER - INFO) as u64)?);
    Ok(HairDefaults {
        segments: bytes.u32("default segments", 16)?,
        thickness: bytes.f32_in("default thickness", 20, Values::NotNegative)?,
        transparency: share("default transparency", 24)?,
        color: [share("default red", 28)?, share("default green", 32)?, share("default blue", 36)?],
        info,
    })
}

/// Points of each strand. Every strand has at least one, so that the points, once they are known to be in the file, bound
/// the number of strands. Moves `at` behind the segments.
fn counts(bytes: Bytes<'_>, bits: u32, default_segments: u32, at: &mut usize) -> Result<Vec<u32>, FileError> {
    let strands = bytes.u32("strands", 4)?;
    let points = bytes.u32("points", 8)?;
    if strands == 0 || strands > points {
        return Err(bytes.error(
            "strands",
            4,
            AssetProblem::out_of_range(strands, "at least 1, and at most the number of points"),
        ));
    }
    bytes.slice("points", HEADER, points.into(), 12)?;
    let counts: Vec<u32> = if bits & SEGMENTS == 0 {
        vec![default_segments.saturating_add(1); strands as usize]
    } else {
        let segments = bytes.slice("segments", HEADER, strands.into(), 2)?;
        *at = HEADER + segments.len();
        segments.as_chunks::<2>().0.iter().map(|&segments| u32::from(u16::from_le_bytes(segments)) + 1).collect()
    };
    let sum: u64 = counts.iter().map(|&count| u64::from(count)).sum();
    if sum != u64::from(points) {
        let kind = AssetProblem::Mismatch { stated: points.into(), found: sum, of: "points make up the strands" };
        return Err(bytes.error("points", 8, kind));
    }
    Ok(counts)
}

/// Walks over the arrays per point.
struct Arrays<'a> {
    bytes: Bytes<'a>,
    bits: u32,
    at: usize,
    counts: &'a [u32],
}

impl Arrays<'_> {
    /// The next array, if its bit is set.
    fn next<const N: usize>(
        &mut self,
        bit: u32,
        field: &str,
        range: Values,
    ) -> Result<Option<Vec<[f32; N]>>, FileError> {
        if self.bits & bit == 0 {
            return Ok(None);
        }
        let points = self.bytes.u32("points", 8)? as usize;
        let array = self.bytes.floats(field, self.at, points, Domain::Vertex(self.counts), range)?;
        self.at += points * 4 * N;
        Ok(Some(array))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two strands of one and two segments, with points alone.
    fn file() -> Vec<u8> {
        let mut file = MAGIC.to_vec();
        [2u32, 5, SEGMENTS | POINTS, 0].iter().for_each(|word| file.extend(word.to_le_bytes()));
        file.resize(HEADER, 0);
        [1u16, 2].iter().for_each(|segments| file.extend(segments.to_le_bytes()));
        (0..15).for_each(|i| file.extend((i as f32).to_le_bytes()));
        file
    }

    #[test]
    fn strands_have_a_point_more_than_segments() {
        let asset = read("f", &file()).expect("sound");
        assert_eq!(asset.counts, [2, 3]);
        assert_eq!(asset.points[4], [12.0, 13.0, 14.0]);
        assert!(asset.vertex_thickness.is_none() && asset.vertex_colors.is_none());
    }

    #[test]
    fn contradictions_are_named() {
        let with = |at: usize, word: u32| {
            let mut file = file();
            file[at..at + 4].copy_from_slice(&word.to_le_bytes());
            read("f", &file).expect_err("not sound").to_string()
        };
        assert_eq!(with(8, 4), "f: points (byte 8): is 4, but 5 points make up the strands");
        assert!(with(4, 6).contains("strands (byte 4): is 6"));
        assert!(with(12, SEGMENTS).contains("arrays (byte 12): is 0x1"));
        assert!(with(12, 1 << 5 | POINTS).contains("arrays (byte 12)"));
        assert!(with(0, 0).contains("magic (byte 0)"));
        assert!(with(20, f32::NAN.to_bits()).contains("default thickness (byte 20)"));
        assert!(with(24, 2f32.to_bits()).contains("default transparency (byte 24): is 2, but must be from 0 to 1"));
        assert!(with(32, (-1f32).to_bits()).contains("default green (byte 32)"));
    }
}
