//! Binary `.tfx` of TressFX 3: a header of 296 bytes, then arrays that it names by their offsets.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | f32 | version, 3.0 |
//! | 4 | u32 | numGuideStrands |
//! | 8 | u32 | vertsPerStrand |
//! | 12 | u32 | followPerGuide |
//! | 16 | u32 | bothEndsImmovable |
//! | 20 | u32 x 31 | reserved |
//! | 144 | u32 | verticesOffset: f32 x 3 per vertex |
//! | 148 | u32 | strandThicknessOffset: f32 per strand |
//! | 152 | u32 | strandUVOffset: f32 x 2 per strand |
//! | 156 | u32 | vertexColorOffset: f32 x 4 per vertex |
//! | 160 | u32 | guideIndexOffset: u32 per strand |
//! | 164 | u32 | vertexUVOffset: f32 x 2 per vertex |
//! | 168 | u32 x 32 | reserved |
//!
//! All little-endian; an offset of 0 means that the array is absent. The reserved words and bytes that no array covers are
//! ignored.

use std::ops::Range;

use tressfx_core::asset::{AssetFormat, AssetProblem, Domain, HairAsset, Values};

use crate::binary::{Bytes, OptionalArray, scalars};
use crate::{FileError, tressfx4};

/// The versions that have this header.
pub(crate) const VERSIONS: Range<f32> = 3.0..4.0;
const HEADER: usize = 296;

const VERTICES: OptionalArray = OptionalArray { field: "verticesOffset", at: 144, header: HEADER, range: Values::Any };
const STRAND_THICKNESS: OptionalArray =
    OptionalArray { field: "strandThicknessOffset", at: 148, header: HEADER, range: Values::NotNegative };
const STRAND_UV: OptionalArray = OptionalArray { field: "strandUVOffset", at: 152, header: HEADER, range: Values::Any };
const VERTEX_COLOR: OptionalArray =
    OptionalArray { field: "vertexColorOffset", at: 156, header: HEADER, range: Values::Share };
const GUIDE_INDEX: OptionalArray =
    OptionalArray { field: "guideIndexOffset", at: 160, header: HEADER, range: Values::Any };
const VERTEX_UV: OptionalArray = OptionalArray { field: "vertexUVOffset", at: 164, header: HEADER, range: Values::Any };

/// Reads a 3.x file.
///
/// # Errors
/// Where an array is not in the file, a count is out of range, a value is not finite, a thickness is negative, or a colour is not from 0 to 1.
pub fn read(name: &str, data: &[u8]) -> Result<HairAsset, FileError> {
    let bytes = Bytes { name, data };
    bytes.slice("header", 0, 1, HEADER as u64)?;
    let version = bytes.f32("version", 0)?;
    if !VERSIONS.contains(&version) {
        return Err(bytes.error("version", 0, AssetProblem::out_of_range(version, "from 3 to below 4")));
    }
    let Some(offset) = VERTICES.offset(bytes)? else {
        return Err(bytes.error(
            VERTICES.field,
            VERTICES.at,
            AssetProblem::out_of_range(0, "the offset of the vertices"),
        ));
    };
    let counts = tressfx4::counts(bytes, ["numGuideStrands", "vertsPerStrand"], offset, 12)?;
    let strands = counts.len();
    let vertices = strands * counts[0] as usize;
    let domain = Domain::Vertex(&counts);
    let points = bytes.floats("vertices", offset, vertices, domain, Values::Any)?;
    let guide_index = GUIDE_INDEX.offset(bytes)?;
    Ok(HairAsset {
        version: Some(version),
        follow_count: Some(bytes.u32("followPerGuide", 12)?),
        both_ends_immovable: bytes.u32("bothEndsImmovable", 16)? != 0,
        strand_thickness: STRAND_THICKNESS.floats(bytes, strands, Domain::Strand)?.map(scalars),
        strand_uvs: STRAND_UV.floats(bytes, strands, Domain::Strand)?,
        vertex_colors: VERTEX_COLOR.floats(bytes, vertices, domain)?,
        guide_index: guide_index.map(|offset| bytes.u32s(GUIDE_INDEX.field, offset, strands)).transpose()?,
        vertex_uvs: VERTEX_UV.floats(bytes, vertices, domain)?,
        ..HairAsset::new(name, AssetFormat::TressFx3, points, counts)
    })
}
