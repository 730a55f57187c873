//! Point caches (`.pc2`): the positions of all vertices of a mesh, sample after sample.
//!
//! | offset | type | field |
//! |---|---|---|
//! | 0 | 12 bytes | `POINTCACHE2` and a 0 |
//! | 12 | i32 | version, 1 |
//! | 16 | i32 | numPoints |
//! | 20 | f32 | startFrame |
//! | 24 | f32 | sampleRate: frames from sample to sample |
//! | 28 | i32 | numSamples |
//! | 32 | f32 x 3 | a position of each point, in each sample |

use tressfx_core::asset::AssetProblem;
use tressfx_core::glam::Vec3;

use crate::FileError;
use crate::binary::Bytes;

pub(crate) const MAGIC: &[u8; 12] = b"POINTCACHE2\0";
const VERSION: u32 = 1;
const HEADER: usize = 32;

/// A mesh in motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointCache {
    /// Vertices of the mesh.
    pub points: usize,
    /// The frame of the first sample.
    pub start_frame: f32,
    /// Frames from sample to sample, above 0.
    pub sample_rate: f32,
    /// Positions, sample after sample.
    pub positions: Vec<Vec3>,
}

impl PointCache {
    /// How many samples it has.
    pub fn samples(&self) -> usize {
        self.positions.len().checked_div(self.points).unwrap_or(0)
    }

    /// The positions of a frame, in between by straight lines; the first or the last sample beyond them. Empty without samples.
    pub fn at(&self, frame: f64) -> Vec<Vec3> {
        let Some(last) = self.samples().checked_sub(1) else { return Vec::new() };
        let place = (frame - f64::from(self.start_frame)) / f64::from(self.sample_rate);
        let place = if place.is_finite() { place.clamp(0.0, last as f64) } else { 0.0 };
        let (first, share) = (place.floor() as usize, place.fract());
        let sample = |index: usize| &self.positions[index * self.points..][..self.points];
        let pairs = sample(first).iter().zip(sample((first + 1).min(last)));
        pairs.map(|(one, next)| one.as_dvec3().lerp(next.as_dvec3(), share).as_vec3()).collect()
    }
}

/// Reads a point cache.
///
/// # Errors
/// Another magic or version, a count of 0 or less, a rate that is not above 0, a file that is cut off, a position that is not finite.
pub fn read(name: &str, data: &[u8]) -> Result<PointCache, FileError> {
    let bytes = Bytes { name, data };
    if bytes.slice("magic", 0, 12, 1)? != MAGIC {
        return Err(bytes.error("magic", 0, AssetProblem::out_of_range("something else", "POINTCACHE2")));
    }
    match bytes.u32("version", 12)? {
        VERSION => {}
        other => return Err(bytes.error("version", 12, AssetProblem::out_of_range(other, "1"))),
    }
    let points = count(bytes, "numPoints", 16)?;
    let start_frame = bytes.f32("startFrame", 20)?;
    let sample_rate = bytes.f32("sampleRate", 24)?;
    if sample_rate <= 0.0 {
        return Err(bytes.error("sampleRate", 24, AssetProblem::out_of_range(sample_rate, "above 0")));
    }
    let samples = count(bytes, "numSamples", 28)?;
    let data = bytes.slice("positions", HEADER, points.saturating_mul(samples), 12)?;
    let place = |index: usize| format!("point {} of sample {}", index as u64 % points, index as u64 / points);
    let mut positions = Vec::with_capacity(data.len() / 12);
    for (index, entry) in data.as_chunks::<12>().0.iter().enumerate() {
        let part = |at: usize| f32::from_le_bytes([entry[at], entry[at + 1], entry[at + 2], entry[at + 3]]);
        let position = Vec3::new(part(0), part(4), part(8));
        if !position.is_finite() {
            let problem = AssetProblem::out_of_range(position, "three finite numbers");
            return Err(bytes.error(&place(index), HEADER + 12 * index, problem));
        }
        positions.push(position);
    }
    Ok(PointCache { points: points as usize, start_frame, sample_rate, positions })
}

fn count(bytes: Bytes<'_>, field: &str, at: usize) -> Result<u64, FileError> {
    match bytes.u32(field, at)? as i32 {
        count if count > 0 => Ok(count as u64),
        count => Err(bytes.error(field, at, AssetProblem::out_of_range(count, "at least 1"))),
    }
}

/// Writes a point cache; read again it is the same to the bit.
///
/// # Errors
/// Counts that do not fit the format or each other.
pub fn to_bytes(name: &str, cache: &PointCache) -> Result<Vec<u8>, FileError> {
    let counts = [("numPoints", cache.points), ("numSamples", cache.samples())];
    for (field, count) in counts {
        if !(1..=i32::MAX as usize).contains(&count) {
            return Err(FileError::new(name, field, AssetProblem::out_of_range(count, "from 1 to 2^31 - 1")));
        }
    }
    if cache.points * cache.samples() != cache.positions.len() {
        let problem = AssetProblem::out_of_range(cache.positions.len(), "a multiple of numPoints");
        return Err(FileError::new(name, "positions", problem));
    }
    let mut out = MAGIC.to_vec();
    out.extend(VERSION.to_le_bytes());
    out.extend((cache.points as u32).to_le_bytes());
    out.extend(cache.start_frame.to_le_bytes());
    out.extend(cache.sample_rate.to_le_bytes());
    out.extend((cache.samples() as u32).to_le_bytes());
    out.extend(cache.positions.iter().flat_map(|position| position.to_array()).flat_map(f32::to_le_bytes));
    Ok(out)
}
