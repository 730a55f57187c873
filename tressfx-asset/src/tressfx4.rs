//! Binary `.tfx` of TressFX 4: a header of 160 bytes, then arrays that it names by their offsets.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | f32 | version, 4.0 |
//! | 4 | u32 | numStrands |
//! | 8 | u32 | vertsPerStrand |
//! | 12 | u32 | offsetPosition: f32 x 4 per vertex, the fourth is the inverse mass |
//! | 16 | u32 | offsetStrandUV: f32 x 2 per strand |
//! | 20 | u32 | offsetVertexUV: f32 x 2 per vertex |
//! | 24 | u32 | offsetStrandThickness: f32 per strand |
//! | 28 | u32 | offsetVertexColor: f32 x 4 per vertex |
//! | 32 | u32 x 32 | reserved |
//!
//! All little-endian; an offset of 0 means that the array is absent. The reserved words and bytes that no array covers are
//! ignored.

use std::ops::Range;

use tressfx_core::asset::{AssetFormat, AssetProblem, Domain, HairAsset, MAX_VERTICES, MIN_VERTICES, Values};

use crate::binary::{Bytes, OptionalArray, scalars};
use crate::{FileError, FileErrorKind};

/// The versions that have this header.
pub(crate) const VERSIONS: Range<f32> = 4.0..5.0;
const HEADER: usize = 160;
const VERSION: f32 = 4.0;

const POSITION: OptionalArray = OptionalArray { field: "offsetPosition", at: 12, header: HEADER, range: Values::Any };
const STRAND_UV: OptionalArray = OptionalArray { field: "offsetStrandUV", at: 16, header: HEADER, range: Values::Any };
const VERTEX_UV: OptionalArray = OptionalArray { field: "offsetVertexUV", at: 20, header: HEADER, range: Values::Any };
const STRAND_THICKNESS: OptionalArray =
    OptionalArray { field: "offsetStrandThickness", at: 24, header: HEADER, range: Values::NotNegative };
const VERTEX_COLOR: OptionalArray =
    OptionalArray { field: "offsetVertexColor", at: 28, header: HEADER, range: Values::Share };

/// Reads a 4.x file.
///
/// # Errors
/// Where an array is not in the file, a count is out of range, a value is not finite, a thickness is negative, or a colour is not from 0 to 1.
pub fn read(name: &str, data: &[u8]) -> Result<HairAsset, FileError> {
    let bytes = Bytes { name, data };
    bytes.slice("header", 0, 1, HEADER as u64)?;
    let version = bytes.f32("version", 0)?;
    if !VERSIONS.contains(&version) {
        return Err(bytes.error("version", 0, AssetProblem::out_of_range(version, "from 4 to below 5")));
    }
    let Some(offset) = POSITION.offset(bytes)? else {
        return Err(bytes.error(
            POSITION.field,
            POSITION.at,
            AssetProblem::out_of_range(0, "the offset of the positions"),
        ));
    };
    let counts = counts(bytes, ["numStrands", "vertsPerStrand"], offset, 16)?;
    let strands = counts.len();
    let vertices = strands * counts[0] as usize;
    let (points, inverse_mass) = positions(bytes, offset, vertices, Domain::Vertex(&counts))?;
    let domain = Domain::Vertex(&counts);
    Ok(HairAsset {
        version: Some(version),
        inverse_mass: Some(inverse_mass),
        strand_uvs: STRAND_UV.floats(bytes, strands, Domain::Strand)?,
        vertex_uvs: VERTEX_UV.floats(bytes, vertices, domain)?,
        strand_thickness: STRAND_THICKNESS.floats(bytes, strands, Domain::Strand)?.map(scalars),
        vertex_colors: VERTEX_COLOR.floats(bytes, vertices, domain)?,
        ..HairAsset::new(name, AssetFormat::TressFx4, points, counts)
    })
}

/// The strand count and the vertex count of a binary header (at bytes 4 and 8), believed only if the positions are there.
pub(crate) fn counts(
    bytes: Bytes<'_>,
    fields: [&'static str; 2],
    positions: usize,
    vertex_size: u64,
) -> Result<Vec<u32>, FileError> {
    let strands = bytes.u32(fields[0], 4)?;
    let vertices = bytes.u32(fields[1], 8)?;
    if strands == 0 {
        return Err(bytes.error(fields[0], 4, AssetProblem::out_of_range(0, "at least 1")));
    }
    if !(MIN_VERTICES..=MAX_VERTICES).contains(&vertices) {
        return Err(bytes.error(fields[1], 8, AssetProblem::out_of_range(vertices, "from 2 to 256")));
    }
    bytes.slice("positions", positions, u64::from(strands) * u64::from(vertices), vertex_size)?;
    Ok(vec![vertices; strands as usize])
}

/// Positions and inverse masses.
fn positions(
    bytes: Bytes<'_>,
    offset: usize,
    vertices: usize,
    domain: Domain<'_>,
) -> Result<(Vec<[f32; 3]>, Vec<f32>), FileError> {
    let values = bytes.floats::<4>("positions", offset, vertices, domain, Values::Any)?;
    if let Some(index) = values.iter().position(|value| value[3] < 0.0) {
        let kind = AssetProblem::out_of_range(values[index][3], "0 or more");
        return Err(bytes.error("inverse mass", offset + 16 * index + 12, kind));
    }
    Ok(values.into_iter().map(|[x, y, z, w]| ([x, y, z], w)).unzip())
}

/// Writes an asset as a 4.x file; read again it has the same points, inverse masses, strand UVs, vertex UVs, strand
/// thickness and vertex colours, to the bit. A [`tressfx_core::asset::Placement`] is applied, because the format cannot keep it, and so
/// are the inverse masses, colours and strand thickness that an asset without any stands for ([`HairAsset::inverse_masses`], [`HairAsset::colors`],
/// [`HairAsset::strand_widths`]): transparency becomes the opacity of colours.
/// [`crate::dropped_by`] says what else the format cannot keep.
///
/// # Errors
/// Where the asset does not pass [`HairAsset::check`], its strands differ in their vertex count, that count is not within
/// 2 to 256, its placement moves a point out
/// of the range of f32, or the file would be larger than its 32-bit offsets allow.
pub fn to_bytes(asset: &HairAsset) -> Result<Vec<u8>, FileError> {
    asset.check()?;
    let vertices = uniform_count(asset)?;
    let strands = u32::try_from(asset.strand_count()).map_err(|_| {
        FileError::new(&asset.name, "numStrands", AssetProblem::out_of_range(asset.strand_count(), "below 2^32"))
    })?;
    let version = asset.version.filter(|_| asset.format == AssetFormat::TressFx4).unwrap_or(VERSION);
    let mut out = vec![0; HEADER];
    out[0..4].copy_from_slice(&version.to_le_bytes());
    out[4..8].copy_from_slice(&strands.to_le_bytes());
    out[8..12].copy_from_slice(&vertices.to_le_bytes());

    let points = asset.placed_points();
    if let Some((_, kind)) = Domain::Vertex(&asset.counts).find_not_finite(points.as_flattened(), 3) {
        return Err(FileError::new(&asset.name, "placed points", kind));
    }
    let positions: Vec<[f32; 4]> =
        points.iter().zip(asset.inverse_masses().iter()).map(|(&[x, y, z], &w)| [x, y, z, w]).collect();
    append(&mut out, asset, &POSITION, Some(positions.as_flattened()))?;
    append(&mut out, asset, &STRAND_UV, asset.strand_uvs.as_deref().map(<[_]>::as_flattened))?;
    append(&mut out, asset, &VERTEX_UV, asset.vertex_uvs.as_deref().map(<[_]>::as_flattened))?;
    append(&mut out, asset, &STRAND_THICKNESS, asset.strand_widths().as_deref())?;
    append(&mut out, asset, &VERTEX_COLOR, asset.colors().as_deref().map(<[_]>::as_flattened))?;
    Ok(out)
}

fn uniform_count(asset: &HairAsset) -> Result<u32, FileError> {
    let error = |kind: FileErrorKind| Err(FileError::new(&asset.name, "vertsPerStrand", kind));
    match asset.uniform_count() {
        Some(count) if (MIN_VERTICES..=MAX_VERTICES).contains(&count) => Ok(count),
        Some(count) => error(AssetProblem::out_of_range(count, "from 2 to 256").into()),
        None => {
            let [min, max] = [asset.counts.iter().min(), asset.counts.iter().max()].map(|c| c.copied().unwrap_or(0));
            error(FileErrorKind::Ragged { min, max })
        }
    }
}

/// Appends an array and writes its offset into the header.
fn append(
    out: &mut Vec<u8>,
    asset: &HairAsset,
    array: &OptionalArray,
    values: Option<&[f32]>,
) -> Result<(), FileError> {
    let Some(values) = values else { return Ok(()) };
    let offset = u32::try_from(out.len())
        .map_err(|_| FileError::new(&asset.name, array.field, AssetProblem::out_of_range(out.len(), "below 2^32")))?;
    out[array.at..array.at + 4].copy_from_slice(&offset.to_le_bytes());
    out.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    Ok(())
}
