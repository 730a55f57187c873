//! Hair grown on a mesh.
//!
//! Roots are evenly over the area, or as a map of densities says, as blue noise: of five times as many places, drawn by density, those are taken away one after the
//! other that have the most others near by (Yuksel 2015, "Sample Elimination for Generating Poisson Disk Sample Sets"), until so many are left as were asked for. What
//! is near grows where the density falls. The same seed gives the same groom.
//!
//! A strand leaves the skin along its normal and bends to where it is combed. Then clumps draw tips together, strands wander, and curl around their way; all of that
//! keeps each edge as long as it was.

mod clump;
mod curl;
mod eliminate;
mod map;
mod near;
mod scatter;
mod skin;
mod strand;

use glam::{DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use thiserror::Error;
use tressfx_core::asset::{AssetFormat, HairAsset, MAX_VERTICES, MIN_VERTICES};
use tressfx_core::body::{BodyError, SkinnedMesh};

pub use map::{MapError, SurfaceMap};
use scatter::scatter;
use skin::Skin;
use strand::Ways;

/// Where a map asks for a smaller share of the length than this, there is no hair.
pub const SHORTEST: f64 = 1.0 / 256.0;
/// Edges in a turn of a curl; with fewer it would be no curl.
const EDGES_A_TURN: f32 = 4.0;

/// How many strands grow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// So many in a square unit of the mesh, where a map of densities is 1.
    Density(f64),
    /// So many on all of the mesh; a map of densities shares them out.
    Count(u32),
}

/// Where strands go when they have left the skin.
#[derive(Clone, Debug, PartialEq)]
pub enum Direction {
    /// Straight on.
    Normal,
    /// To one side, along the skin.
    Comb(Vec3),
    /// As a map of three channels says, of which 0.5 is zero: red in the direction in which the first texture coordinate grows, green in that of the second,
    /// which goes down the picture, blue along the normal. A short vector bends less.
    Map(SurfaceMap),
}

/// How hair grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// How many strands.
    pub amount: Amount,
    /// What share of that there is from place to place: one channel.
    pub density_map: Option<SurfaceMap>,
    /// Vertices of each strand.
    pub vertices: u32,
    /// Length of a strand, in the unit of the mesh.
    pub length: f32,
    /// What share of the length there is from place to place: one channel. Below [`SHORTEST`] no hair grows.
    pub length_map: Option<SurfaceMap>,
    /// By what share of it strands are shorter, by chance, 0 to 1.
    pub variation: f32,
    /// Where hair is combed to.
    pub direction: Direction,
    /// How far it lies down on its way to the tip, from 0, standing, to 1, all the way to where it is combed.
    pub lie: f32,
    /// By how much directions differ from strand to strand, 0 to 1.
    pub noise: f32,
    /// By how much strands wander on their way to the tip, 0 to 1.
    pub frizz: f32,
    /// Strands to which the others around them are drawn; 0 for none.
    pub clumps: u32,
    /// How near to them tips are drawn, 0 to 1; from the root on by the square of the way.
    pub clump: f32,
    /// The radius of curls at the tip of a strand of full length; 0 for none.
    pub curl_radius: f32,
    /// The way along a strand in which a curl turns once.
    pub curl_length: f32,
    /// Of everything that is by chance.
    pub seed: u64,
}

impl Default for Growth {
    /// Ten thousand short strands a square unit that stand.
    fn default() -> Self {
        Self {
            amount: Amount::Density(1e4),
            density_map: None,
            vertices: 8,
            length: 0.05,
            length_map: None,
            variation: 0.2,
            direction: Direction::Normal,
            lie: 0.7,
            noise: 0.1,
            frizz: 0.0,
            clumps: 0,
            clump: 0.7,
            curl_radius: 0.0,
            curl_length: 0.05,
            seed: 0,
        }
    }
}

/// Why hair does not grow.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GrowError {
    /// The mesh is not sound.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// A number outside of its range.
    #[error("{name} is {value}, but must be {expected}")]
    Number {
        /// What it is.
        name: &'static str,
        /// The number.
        value: f64,
        /// What would be allowed.
        expected: &'static str,
    },
    /// A map over a mesh that says nothing of where its texels are.
    #[error("{mesh} has no texture coordinates, or parts of it have none: there is no place for the {map} map")]
    NoTextureCoordinates {
        /// The mesh.
        mesh: String,
        /// Which map.
        map: &'static str,
    },
    /// A map with another number of channels than its use takes.
    #[error("the {map} map has {found} channels, but must have {expected}")]
    Channels {
        /// Which map.
        map: &'static str,
        /// Its channels.
        found: u32,
        /// How many it must have.
        expected: u32,
    },
    /// Maps, or triangles without an area, leave nothing or too little.
    #[error("{mesh}: hair would grow on {share:.1e} of its area, which is none, or too little for so many strands")]
    Bare {
        /// The mesh.
        mesh: String,
        /// The share of the area that maps leave.
        share: f64,
    },
}

/// A place on a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinPlace {
    /// The triangle.
    pub triangle: usize,
    /// The shares of its corners.
    pub barycentric: [f64; 3],
    /// Where it is.
    pub position: DVec3,
    /// The normal there, smooth across the edges of triangles.
    pub normal: DVec3,
}

/// A groom on a mesh in its bind pose, in the unit of the mesh. Where the mesh has texture coordinates, strands have those of their roots.
///
/// # Errors
/// A mesh that is not sound, a number outside of its range, fewer than one strand on all of the mesh, maps on a mesh without texture coordinates or with another
/// number of channels than they must have, and maps that leave no place for hair.
pub fn grow(mesh: &SkinnedMesh, growth: &Growth) -> Result<HairAsset, GrowError> {
    growth.check(mesh)?;
    let skin = Skin::new(mesh);
    let roots = scatter(&skin, growth)?;
    let strands = roots.places.len();
    if growth.clumps as usize > strands {
        let (value, expected) = (growth.clumps.into(), "at most as many as there are strands");
        return Err(GrowError::Number { name: "clumps", value, expected });
    }
    let mut random = Pcg32::seed_from_u64(growth.seed ^ 1);
    let mut points = Vec::with_capacity(strands * growth.vertices as usize);
    let ways = Ways::new(growth, &skin);
    roots.places.iter().for_each(|place| ways.strand(place, &mut random, &mut points));
    growth.style(&roots, &mut points);
    let points = points.iter().map(|point| point.as_vec3().to_array()).collect();
    let counts = vec![growth.vertices; strands];
    let mut asset = HairAsset::new(format!("grown on {}", mesh.name), AssetFormat::TressFx4, points, counts);
    if !mesh.uvs.is_empty() {
        let uvs = roots.places.iter().map(|place| skin.uv(place).map(|part| part as f32));
        asset.strand_uvs = Some(uvs.collect());
    }
    Ok(asset)
}

/// Places on a mesh, as far from each other as their density lets them be: the roots of [`grow`].
///
/// # Errors
/// As [`grow`].
pub fn roots(mesh: &SkinnedMesh, growth: &Growth) -> Result<Vec<SkinPlace>, GrowError> {
    growth.check(mesh)?;
    Ok(scatter(&Skin::new(mesh), growth)?.places)
}

impl Growth {
    fn check(&self, mesh: &SkinnedMesh) -> Result<(), GrowError> {
        mesh.check()?;
        self.check_numbers()?;
        let directions = match &self.direction {
            Direction::Map(map) => Some(map),
            _ => None,
        };
        let maps = [
            ("density", &self.density_map.as_ref(), 1),
            ("length", &self.length_map.as_ref(), 1),
            ("direction", &directions, 3),
        ];
        for (map, given, expected) in maps {
            match given {
                Some(_) if mesh.uvs.is_empty() => {
                    return Err(GrowError::NoTextureCoordinates { mesh: mesh.name.clone(), map });
                }
                Some(given) if given.channels() != expected => {
                    return Err(GrowError::Channels { map, found: given.channels(), expected });
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn check_numbers(&self) -> Result<(), GrowError> {
        let wrong = |name, value, expected| Err(GrowError::Number { name, value, expected });
        let shares = [
            ("variation", self.variation),
            ("lie", self.lie),
            ("noise", self.noise),
            ("frizz", self.frizz),
            ("clump", self.clump),
        ];
        if let Some(&(name, value)) = shares.iter().find(|(_, value)| !(0.0..=1.0).contains(value)) {
            return wrong(name, typed(value), "from 0 to 1");
        }
        let edge = self.length / (self.vertices.max(2) - 1) as f32;
        match *self {
            Self { amount: Amount::Density(density), .. } if !(density > 0.0 && density.is_finite()) => {
                wrong("density", density, "above 0")
            }
            Self { length, .. } if !(length > 0.0 && length.is_finite()) => wrong("length", typed(length), "above 0"),
            Self { direction: Direction::Comb(comb), .. } if !comb.is_finite() => wrong("comb", f64::NAN, "finite"),
            Self { vertices, .. } if !(MIN_VERTICES..=MAX_VERTICES).contains(&vertices) => {
                wrong("vertices", vertices.into(), "from 2 to 256")
            }
            Self { curl_radius, length, .. } if !(0.0..length).contains(&curl_radius) => {
                wrong("curl radius", typed(curl_radius), "0, or more and below the length")
            }
            Self { curl_radius, curl_length, .. }
                if curl_radius > 0.0 && !(curl_length >= EDGES_A_TURN * edge && curl_length.is_finite()) =>
            {
                wrong(
                    "curl length",
                    typed(curl_length),
                    "that of four edges at least: ask for longer turns, or for more vertices",
                )
            }
            _ => Ok(()),
        }
    }

    /// Draws strands together, lets them wander, and curls them.
    fn style(&self, roots: &scatter::Roots, points: &mut [DVec3]) {
        let vertices = self.vertices as usize;
        let middles =
            if self.clumps > 0 { clump::draw_together(self, roots, points) } else { (0..roots.places.len()).collect() };
        for (strand, (points, &middle)) in points.chunks_exact_mut(vertices).zip(&middles).enumerate() {
            if self.frizz > 0.0 {
                curl::wander(self.frizz.into(), points, &mut Pcg32::new(self.seed, strand as u64));
            }
            if self.curl_radius > 0.0 {
                // Strands of a clump turn together.
                let phase = Pcg32::new(self.seed, (1 << 32) + middle as u64).random();
                curl::curl(self, points, phase, roots.places[middle].normal.any_orthonormal_vector());
            }
        }
    }
}

/// A number as it was typed: 0.1, and not what f64 makes of the nearest f32.
fn typed(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(value.into())
}
