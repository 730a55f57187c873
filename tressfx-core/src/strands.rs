//! Strands: an asset prepared for simulation and rendering.
//!
//! Every strand has the same number of vertices, lengths and frames are known, follow strands are placed, and the guides
//! are in an order of which every prefix is an even sample. All arrays are plain and strand-major
//! (`strand * vertices + vertex`); [`Strands::interleave`] gives the order of the GPU. No strand is added as padding.
//!
//! Guide `g` is strand `g`; follow strand `f` of guide `g` is strand `guides * (1 + f) + g`.

mod bounds;
mod center;
mod error;
mod follow;
mod frames;
mod layout;
mod options;
mod order;
mod resample;
mod units;

use glam::{Quat, Vec2, Vec3, Vec4};

use crate::asset::HairAsset;
use resample::Resampled;

pub use bounds::Bounds;
pub use center::relative_to;
pub use error::StrandsError;
pub use frames::shortest_turn;
pub use options::{MAX_FOLLOWS, StrandOptions};
pub use units::metres_per_unit;

/// What the GPU gets of one section of a groom, in the unit of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Strands {
    /// The asset that they were made from.
    pub name: String,
    /// Strands that are simulated: those of the file.
    pub guides: u32,
    /// Vertices of every strand, 2 to 256.
    pub vertices: u32,
    /// Follow strands of every guide.
    pub follows: u32,
    /// Rest pose of the guides: position, and inverse mass in `w` (0 is pinned). `guides * vertices`.
    pub rest: Vec<Vec4>,
    /// Distance to the next vertex, 0 at the tip. `guides * vertices`.
    pub rest_lengths: Vec<f32>,
    /// Frame at each vertex, whose x axis is the edge to the next vertex; minimal twist. `guides * vertices`.
    pub rest_frames: Vec<Quat>,
    /// Unit tangents of the rest pose in `xyz`, 0 in `w`. `guides * vertices`.
    pub tangents: Vec<Vec4>,
    /// Factor of the strand's width: 1 at the root, 0 at the tip. `guides * vertices`.
    pub thickness: Vec<f32>,
    /// Offset of each follow strand from its guide, perpendicular to the first edge of the guide, in the space of the rest
    /// pose: turn it by the rotation that the root has made since. `w` is 0. `follow * guides + guide`, so that strand
    /// `guides + i` has offset `i`.
    pub follow_offsets: Vec<Vec4>,
    /// The radius in which the offsets are.
    pub follow_radius: f32,
    /// How much further than at the root a follow strand is from its guide at the tip: at vertex `k` the offset is
    /// multiplied by `1 + tip_separation * k / (vertices - 1)`.
    pub tip_separation: f32,
    /// Texture coordinates of the root of each guide.
    pub strand_uv: Option<Vec<Vec2>>,
    /// Colour and opacity, RGBA from 0 to 1 as the file has them, where it has any: [`HairAsset::colors`]. `guides * vertices`.
    pub vertex_colors: Option<Vec<Vec4>>,
    /// Thickness as the file has it, where it has any: [`HairAsset::widths`]. `guides * vertices`.
    pub vertex_widths: Option<Vec<f32>>,
    /// Unit direction of the first edge, of each guide, that has a length.
    pub root_directions: Vec<Vec3>,
    /// The box around the rest pose of all strands, follow strands too.
    pub bounds: Bounds,
    /// Metres that a unit of the file stands for.
    pub metres_per_unit: f32,
    /// The strand of the file that each guide is.
    pub order: Vec<u32>,
}

impl Strands {
    /// Prepares an asset.
    ///
    /// # Errors
    /// Where the asset does not pass [`HairAsset::check`], an option (or the file's hint in its place) is out of range,
    /// there are 2^32 vertices or more, or a strand is so large that its lengths are not finite.
    pub fn new(asset: &HairAsset, options: &StrandOptions) -> Result<Self, StrandsError> {
        asset.check()?;
        let settings = options.resolve(asset)?;
        let order = order::order(settings.guides, options.shuffle, options.seed);
        let points = asset.placed_points();
        let ranges: Vec<_> = asset.ranges().collect();
        let in_order = order.iter().map(|&strand| ranges[strand as usize].clone()).collect();
        let resampled = Resampled::new(&points, in_order, settings.vertices);
        let masses = resampled.masses(&asset.inverse_masses());
        let rest = resampled.values(&points).into_iter().zip(masses);
        let colors = asset.colors().map(|colors| resampled.values(&colors));
        let widths = asset.widths().map(|widths| resampled.values(widths.as_chunks::<1>().0));
        let mut strands = Self {
            name: asset.name.clone(),
            guides: settings.guides,
            vertices: settings.vertices,
            follows: settings.follows,
            rest: rest.map(|(point, mass)| Vec3::from(point).extend(mass)).collect(),
            rest_lengths: Vec::new(),
            rest_frames: Vec::new(),
            tangents: Vec::new(),
            thickness: Vec::new(),
            follow_offsets: Vec::new(),
            follow_radius: 0.0,
            tip_separation: options.tip_separation,
            strand_uv: asset.strand_uvs.as_ref().map(|uvs| order.iter().map(|&s| uvs[s as usize].into()).collect()),
            vertex_colors: colors.map(|colors| colors.into_iter().map(Vec4::from).collect()),
            vertex_widths: widths.map(Vec::into_flattened),
            root_directions: Vec::with_capacity(order.len()),
            bounds: Bounds::default(),
            metres_per_unit: 1.0,
            order,
        };
        strands.derive_along_strands();
        strands.check_finite()?;
        strands.metres_per_unit = options.metres_per_unit.unwrap_or_else(|| metres_per_unit(&strands.guide_bounds()));
        strands.follow_radius = settings.follow_radius(strands.metres_per_unit);
        strands.place_follows(options.seed);
        Ok(strands)
    }

    /// Guides and follow strands.
    pub fn strand_count(&self) -> u32 {
        self.guides * (1 + self.follows)
    }

    /// The box around the rest pose of the guides.
    pub fn guide_bounds(&self) -> Bounds {
        Bounds::of(self.rest.iter().map(|vertex| vertex.truncate()))
    }

    /// The rest pose of all strands, follow strands too: `strand * vertices + vertex`.
    pub fn rest_of_all(&self) -> Vec<Vec4> {
        let vertices = self.vertices as usize;
        let follows = self.follow_offsets.chunks(self.guides as usize).flat_map(|offsets| {
            let guides = self.rest.chunks(vertices).zip(offsets);
            guides.flat_map(|(strand, &offset)| {
                let spread = |vertex| follow::spread(self.tip_separation, vertex, self.vertices);
                strand.iter().enumerate().map(move |(vertex, &position)| position + offset * spread(vertex))
            })
        });
        self.rest.iter().copied().chain(follows).collect()
    }

    fn derive_along_strands(&mut self) {
        for strand in self.rest.chunks(self.vertices as usize) {
            let directions = frames::directions(strand);
            let start = self.rest_lengths.len();
            self.rest_lengths.extend(frames::rest_lengths(strand));
            self.rest_frames.extend(frames::rest_frames(&directions));
            self.tangents.extend(frames::tangents(&directions));
            self.thickness.extend(frames::thickness(&self.rest_lengths[start..]));
            self.root_directions.push(directions[0].as_vec3());
        }
    }

    fn check_finite(&self) -> Result<(), StrandsError> {
        let vertices = self.vertices as usize;
        let lengths = self.rest_lengths.chunks(vertices).map(|lengths| lengths.iter().sum::<f32>());
        let finite = self
            .rest
            .chunks(vertices)
            .zip(lengths)
            .map(|(strand, length)| length.is_finite() && strand.iter().all(|vertex| vertex.is_finite()));
        match finite.zip(&self.order).find(|&(finite, _)| !finite) {
            None => Ok(()),
            Some((_, &strand)) => Err(StrandsError::Overflow { file: self.name.clone(), strand }),
        }
    }

    fn place_follows(&mut self, seed: u64) {
        let disc = follow::Disc { follows: self.follows, radius: self.follow_radius, seed };
        let guides = self.guides as usize;
        self.follow_offsets = vec![Vec4::ZERO; guides * self.follows as usize];
        for (guide, &strand) in self.order.iter().enumerate() {
            let frame = self.rest_frames[guide * self.vertices as usize];
            for (follow, offset) in disc.offsets(frame, strand).enumerate() {
                self.follow_offsets[follow * guides + guide] = offset;
            }
        }
        self.bounds = Bounds::of(self.rest_of_all().iter().map(|position| position.truncate()));
    }
}
