//! `.tfxbone` of TressFX 4: the bones that move each strand. No magic and no header; all little-endian.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | i32: bones |
//! | each bone | i32: its index, from 0 in order; i32: bytes of its name with the 0 at its end; the name |
//! | 4 | i32: strands |
//! | 36 each strand | i32: its index; four times i32: a bone of the table above, f32: its weight |
//!
//! The index of a strand is not kept: strands are in order.

use tressfx_core::asset::AssetProblem;
use tressfx_core::body::Influences;

use crate::FileError;
use crate::binary::Bytes;

/// By how much weights may miss 1 before they count as made to sum to it.
const ROUNDING: f32 = 1e-4;
const STRAND: usize = 36;

/// The bones of the strands of a groom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StrandBones {
    /// Names of bones.
    pub bones: Vec<String>,
    /// One a strand of the file of the groom: bones of the list above, by weights that sum to 1.
    pub strands: Vec<Influences>,
    /// Strands whose weights in the file sum to something else than 1, by more than 1e-4.
    pub normalised: usize,
}

impl StrandBones {
    /// The same with the joints of a mesh, found by their names.
    ///
    /// # Errors
    /// A bone with weight that the mesh does not have; the error names it and the first strand that it moves.
    pub fn on_joints(&self, file: &str, joints: &[String]) -> Result<Vec<Influences>, FileError> {
        let known: Vec<_> = self.bones.iter().map(|bone| joints.iter().position(|joint| joint == bone)).collect();
        let on_joints = |(strand, of): (usize, &Influences)| {
            let mut found = *of;
            for slot in (0..4).filter(|&slot| of.weights[slot] > 0.0) {
                let bone = of.joints[slot] as usize;
                let Some(joint) = known[bone] else {
                    let field = format!("bone {:?} of strand {strand}", self.bones[bone]);
                    return Err(FileError::new(
                        file,
                        field,
                        AssetProblem::out_of_range("absent", "a joint of the mesh"),
                    ));
                };
                found.joints[slot] = joint as u32;
            }
            Ok(found)
        };
        self.strands.iter().enumerate().map(on_joints).collect()
    }
}

/// Whether a file may be one: there is no magic, so the first bone has to be bone 0 with a name.
pub(crate) fn is_like(data: &[u8]) -> bool {
    let bytes = Bytes { name: "", data };
    let word = |at| bytes.u32("", at).unwrap_or(0);
    let name = data.get(12..12 + (word(8) as usize).min(data.len())).unwrap_or_default();
    (1..1 << 16).contains(&word(0)) && word(4) == 0 && name.len() > 1 && name.last() == Some(&0)
}

/// Reads a `.tfxbone` file.
///
/// # Errors
/// A file that is cut off, a bone out of order, a name without an end, a strand with a bone that is not in the table, with a weight that is negative or
/// not finite, or without any weight. The error names bone or strand.
pub fn read(name: &str, data: &[u8]) -> Result<StrandBones, FileError> {
    let bytes = Bytes { name, data };
    let (bones, at) = table(bytes)?;
    let count = count(bytes, "number of strands", at)?;
    let records = bytes.slice("strands", at + 4, count, STRAND as u64)?;
    let mut read = StrandBones { bones, ..StrandBones::default() };
    for strand in 0..records.len() / STRAND {
        let (of, sum) = influences(bytes, at + 4 + STRAND * strand, strand, read.bones.len())?;
        read.normalised += usize::from((sum - 1.0).abs() > ROUNDING);
        read.strands.push(of);
    }
    Ok(read)
}

/// A signed count that is at least 1.
fn count(bytes: Bytes<'_>, field: &str, at: usize) -> Result<u64, FileError> {
    match bytes.u32(field, at)? as i32 {
        count if count > 0 => Ok(count as u64),
        count => Err(bytes.error(field, at, AssetProblem::out_of_range(count, "at least 1"))),
    }
}

/// The names of the bones, and where the table ends.
fn table(bytes: Bytes<'_>) -> Result<(Vec<String>, usize), FileError> {
    let (bones, mut at) = (count(bytes, "number of bones", 0)?, 4);
    // The least that a bone takes: its two numbers, and a name of one byte.
    bytes.slice("bones", at, bones, 9)?;
    let mut names = Vec::new();
    for bone in 0..bones {
        let index = bytes.u32(&format!("index of bone {bone}"), at)? as i32;
        if i64::from(index) != bone as i64 {
            let field = format!("index of bone {bone}");
            return Err(bytes.error(&field, at, AssetProblem::out_of_range(index, "its place in the table")));
        }
        let field = format!("name of bone {bone}");
        let length = count(bytes, &field, at + 4)?;
        let text = bytes.slice(&field, at + 8, length, 1)?;
        let Some((0, text)) = text.split_last() else {
            let last = at + 8 + text.len() - 1;
            return Err(bytes.error(&field, last, AssetProblem::out_of_range("unended", "ended by a 0")));
        };
        names.push(String::from_utf8_lossy(text).into_owned());
        at += 8 + length as usize;
    }
    Ok((names, at))
}

/// Those of a strand, and what its weights sum to in the file.
fn influences(bytes: Bytes<'_>, at: usize, strand: usize, bones: usize) -> Result<(Influences, f32), FileError> {
    let mut pairs = [(0, 0.0); 4];
    for (slot, pair) in pairs.iter_mut().enumerate() {
        let (field, at) = (format!("bone {slot} of strand {strand}"), at + 4 + 8 * slot);
        let bone = bytes.u32(&field, at)?;
        if bone as usize >= bones {
            return Err(bytes.error(&field, at, AssetProblem::out_of_range(bone as i32, "a bone of the table")));
        }
        let field = format!("weight {slot} of strand {strand}");
        *pair = (bone, bytes.f32_in(&field, at + 4, tressfx_core::asset::Values::NotNegative)?);
    }
    let sum = pairs.iter().map(|pair| pair.1).sum();
    match Influences::strongest(&pairs) {
        Some(of) => Ok((of, sum)),
        None => {
            let field = format!("weights of strand {strand}");
            Err(bytes.error(&field, at + 8, AssetProblem::out_of_range(sum, "a sum above 0")))
        }
    }
}
