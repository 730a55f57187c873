//! Counts, lengths and bounds of an asset, and what is unusual about it: what `tressfx info` prints.

use glam::DVec3;
use serde::Serialize;

use tressfx_core::asset::{AssetError, AssetFormat, HairAsset, MAX_VERTICES};
use tressfx_core::strands::{Bounds, metres_per_unit};

/// Segments up to this fraction of the median strand length count as having no length: in exported grooms, strands that
/// were collapsed to a point keep the noise of the float coordinates.
const NEGLIGIBLE: f64 = 1e-5;

/// The facts about an asset, in the unit of the file, with the file's placement applied.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The file.
    pub name: String,
    /// Its format.
    pub format: AssetFormat,
    /// The version that it states.
    pub version: Option<f32>,
    /// Strands.
    pub strands: usize,
    /// Vertices of all strands.
    pub vertices: usize,
    /// Fewest vertices of a strand.
    pub min_vertices: u32,
    /// Most vertices of a strand.
    pub max_vertices: u32,
    /// Lengths of the strands.
    pub length: LengthStats,
    /// The box around all points.
    pub bounds: Bounds,
    /// Metres that a unit of the file stands for, as guessed from the size of the groom.
    pub metres_per_unit: f32,
    /// Follow strands per guide that the header asks for.
    pub follow_count: u32,
    /// The radius for them that the header asks for.
    pub follow_radius: Option<f32>,
    /// Vertices whose inverse mass is 0.
    pub pinned_vertices: usize,
    /// Mean colour and opacity of the vertices, RGBA as the file has them, where it has any ([`HairAsset::colors`]).
    pub mean_color: Option<[f32; 4]>,
    /// Least and largest thickness of a vertex, where the file has any ([`HairAsset::widths`]).
    pub thickness: Option<[f32; 2]>,
    /// Optional arrays that the file has.
    pub arrays: Vec<&'static str>,
    /// What is unusual, though harmless.
    pub oddities: Oddities,
}

/// Lengths of strands, in the unit of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LengthStats {
    /// Shortest.
    pub min: f64,
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Longest.
    pub max: f64,
}

/// What is unusual about an asset, though strands are made from it all the same. Each field counts occurrences.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Oddities {
    /// Two successive vertices at the same place, up to 1e-5 of the median strand length.
    pub zero_length_segments: usize,
    /// Strands all of whose segments have no length in this sense.
    pub zero_length_strands: usize,
    /// Strands of one vertex. They become strands of no length.
    pub single_vertex_strands: usize,
    /// Strands of more vertices than [`MAX_VERTICES`]. They are resampled.
    pub long_strands: usize,
    /// Strands whose root is not pinned.
    pub loose_roots: usize,
}

impl Oddities {
    /// Segments of at most `negligible` count as having no length.
    fn new(asset: &HairAsset, points: &[[f32; 3]], masses: &[f32], negligible: f64) -> Self {
        let mut oddities = Self::default();
        for range in asset.ranges() {
            let short = segment_lengths(&points[range.clone()]).filter(|&length| length <= negligible).count();
            oddities.zero_length_segments += short;
            oddities.zero_length_strands += usize::from(short + 1 == range.len());
            oddities.single_vertex_strands += usize::from(range.len() == 1);
            oddities.long_strands += usize::from(range.len() > MAX_VERTICES as usize);
            oddities.loose_roots += usize::from(masses[range.start] != 0.0);
        }
        oddities
    }

    /// True where nothing is unusual.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

impl Report {
    /// Looks through an asset.
    ///
    /// # Errors
    /// Where the asset does not pass [`HairAsset::check`].
    pub fn new(asset: &HairAsset) -> Result<Self, AssetError> {
        asset.check()?;
        let points = asset.placed_points();
        let masses = asset.inverse_masses();
        let length = LengthStats::new(&mut strand_lengths(asset, &points));
        let bounds = Bounds::of(points.iter().map(|&point| point.into()));
        Ok(Self {
            name: asset.name.clone(),
            format: asset.format,
            version: asset.version,
            strands: asset.strand_count(),
            vertices: asset.points.len(),
            min_vertices: asset.counts.iter().copied().min().unwrap_or(0),
            max_vertices: asset.counts.iter().copied().max().unwrap_or(0),
            length,
            bounds,
            metres_per_unit: metres_per_unit(&bounds),
            follow_count: asset.follow_count.unwrap_or(0),
            follow_radius: asset.follow_radius,
            pinned_vertices: masses.iter().filter(|&&mass| mass == 0.0).count(),
            mean_color: asset.colors().map(|colors| mean(&colors)),
            thickness: asset.widths().map(|widths| range(&widths)),
            arrays: arrays(asset),
            oddities: Oddities::new(asset, &points, &masses, NEGLIGIBLE * length.median),
        })
    }
}

impl LengthStats {
    /// Sorts the lengths.
    fn new(lengths: &mut [f64]) -> Self {
        lengths.sort_by(f64::total_cmp);
        let (Some(&min), Some(&max)) = (lengths.first(), lengths.last()) else { return Self::default() };
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        Self { min, mean, median: lengths[lengths.len() / 2], max }
    }
}

fn strand_lengths(asset: &HairAsset, points: &[[f32; 3]]) -> Vec<f64> {
    asset.ranges().map(|range| segment_lengths(&points[range]).sum()).collect()
}

fn segment_lengths(strand: &[[f32; 3]]) -> impl Iterator<Item = f64> + '_ {
    strand.windows(2).map(|pair| segment_length(pair[0], pair[1]))
}

/// The distance of two points, computed in f64.
fn segment_length(a: [f32; 3], b: [f32; 3]) -> f64 {
    DVec3::from_array(a.map(f64::from)).distance(DVec3::from_array(b.map(f64::from)))
}

fn mean(colors: &[[f32; 4]]) -> [f32; 4] {
    let sum = |part: usize| colors.iter().map(|color| f64::from(color[part])).sum::<f64>();
    [0, 1, 2, 3].map(|part| (sum(part) / colors.len() as f64) as f32)
}

fn range(values: &[f32]) -> [f32; 2] {
    values.iter().fold([f32::INFINITY, 0.0], |[low, high], &value| [low.min(value), high.max(value)])
}

fn arrays(asset: &HairAsset) -> Vec<&'static str> {
    [
        ("inverse mass", asset.inverse_mass.is_some()),
        ("strand UVs", asset.strand_uvs.is_some()),
        ("vertex UVs", asset.vertex_uvs.is_some()),
        ("strand thickness", asset.strand_thickness.is_some()),
        ("vertex thickness", asset.vertex_thickness.is_some()),
        ("vertex transparency", asset.vertex_transparency.is_some()),
        ("vertex colours", asset.vertex_colors.is_some()),
        ("guide index", asset.guide_index.is_some()),
    ]
    .into_iter()
    .filter_map(|(name, present)| present.then_some(name))
    .collect()
}
