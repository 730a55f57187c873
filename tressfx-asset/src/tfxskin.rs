//! `.tfxskin` of TressFX 3: the triangle that each strand grows on. A header of 268 bytes, then two arrays that it names by their offsets.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | u32 | version, 1 |
//! | 4 | u32 | numHairs |
//! | 8 | u32 | numTriangles, not read |
//! | 136 | u32 | mapOffset: a strand's u32 mesh, u32 triangle, f32 x 3 barycentric coordinates, u32 reserved |
//! | 140 | u32 | strandUVOffset: f32 x 3 a strand, the third unused; 0 is none |

use tressfx_core::asset::{AssetProblem, Domain, Values};

use crate::FileError;
use crate::binary::{Bytes, OptionalArray};

const VERSION: u32 = 1;
const HEADER: usize = 268;
const MAP: OptionalArray = OptionalArray { field: "mapOffset", at: 136, header: HEADER, range: Values::Any };
const STRAND_UV: OptionalArray = OptionalArray { field: "strandUVOffset", at: 140, header: HEADER, range: Values::Any };
const ENTRY: usize = 24;
/// By how much barycentric coordinates may miss a sum of 1.
const ROUNDING: f32 = 1e-3;

/// Where on a mesh a strand grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleRoot {
    /// The mesh, as the file counts them.
    pub mesh: u32,
    /// The triangle of it.
    pub triangle: u32,
    /// Barycentric coordinates; they sum to 1.
    pub barycentric: [f32; 3],
}

/// The triangles of the strands of a groom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrandTriangles {
    /// One a strand.
    pub roots: Vec<TriangleRoot>,
    /// One a strand, where the file has them.
    pub uvs: Option<Vec<[f32; 2]>>,
}

/// Whether a file may be one: there is no magic, so the version and the place of the map have to be right.
pub(crate) fn is_like(data: &[u8]) -> bool {
    let bytes = Bytes { name: "", data };
    let offset = bytes.u32("", MAP.at).unwrap_or(0) as usize;
    bytes.u32("", 0).is_ok_and(|version| version == VERSION) && (HEADER..data.len()).contains(&offset)
}

/// Reads a `.tfxskin` file.
///
/// # Errors
/// Another version, an array that is not in the file, a value that is not finite, barycentric coordinates that do not sum to 1.
pub fn read(name: &str, data: &[u8]) -> Result<StrandTriangles, FileError> {
    let bytes = Bytes { name, data };
    bytes.slice("header", 0, 1, HEADER as u64)?;
    match bytes.u32("version", 0)? {
        VERSION => {}
        other => return Err(bytes.error("version", 0, AssetProblem::out_of_range(other, "1"))),
    }
    let strands = bytes.u32("numHairs", 4)? as usize;
    let Some(offset) = MAP.offset(bytes)? else {
        return Err(bytes.error(MAP.field, MAP.at, AssetProblem::out_of_range(0, "the offset of the map")));
    };
    bytes.slice(MAP.field, offset, strands as u64, ENTRY as u64)?;
    let roots = (0..strands).map(|strand| root(bytes, offset + ENTRY * strand, strand)).collect::<Result<_, _>>()?;
    let uvs: Option<Vec<[f32; 3]>> = STRAND_UV.floats(bytes, strands, Domain::Strand)?;
    Ok(StrandTriangles { roots, uvs: uvs.map(|uvs| uvs.into_iter().map(|[u, v, _]| [u, v]).collect()) })
}

fn root(bytes: Bytes<'_>, at: usize, strand: usize) -> Result<TriangleRoot, FileError> {
    let field = format!("barycentric coordinates of strand {strand}");
    let at_of = |corner: usize| at + 8 + 4 * corner;
    let barycentric = [bytes.f32(&field, at_of(0))?, bytes.f32(&field, at_of(1))?, bytes.f32(&field, at_of(2))?];
    let sum: f32 = barycentric.iter().sum();
    if (sum - 1.0).abs() > ROUNDING {
        return Err(bytes.error(&field, at_of(0), AssetProblem::out_of_range(sum, "a sum of 1")));
    }
    Ok(TriangleRoot { mesh: bytes.u32("mesh", at)?, triangle: bytes.u32("triangle", at + 4)?, barycentric })
}
