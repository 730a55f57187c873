//! Hair grown on a mesh.
//!
//! Roots are evenly over the area, as blue noise: of five times as many places, drawn evenly by area, those are taken away one after the other that have the most others near by
//! (Yuksel 2015, "Sample Elimination for Generating Poisson Disk Sample Sets"), until so many are left as were asked for. The same seed gives the same groom.

mod eliminate;

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg32;
use thiserror::Error;
use tressfx_core::asset::{AssetFormat, HairAsset, MAX_VERTICES, MIN_VERTICES};
use tressfx_core::body::{BodyError, SkinnedMesh};

use eliminate::eliminate;

/// Places for each root that is wanted.
const CANDIDATES: usize = 5;
/// More strands than this nobody can draw; a density in the wrong unit easily asks for them.
const MOST_STRANDS: f64 = 2e6;

/// How hair grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Growth {
    /// Strands in a square unit of the mesh.
    pub density: f64,
    /// Vertices of each strand.
    pub vertices: u32,
    /// Length of a strand, in the unit of the mesh.
    pub length: f32,
    /// By what share of it strands are shorter, by chance, 0 to 1.
    pub variation: f32,
    /// Where hair is combed to. It lies along the skin; with zero, hair stands.
    pub comb: Vec3,
    /// How far it lies down on its way to the tip, from 0, standing, to 1, along the skin.
    pub lie: f32,
    /// By how much directions differ from strand to strand, 0 to 1.
    pub noise: f32,
    /// Of everything that is by chance.
    pub seed: u64,
}

impl Default for Growth {
    /// Ten thousand short strands a square unit that stand.
    fn default() -> Self {
        Self {
            density: 1e4,
            vertices: 8,
            length: 0.05,
            variation: 0.2,
            comb: Vec3::ZERO,
            lie: 0.7,
            noise: 0.1,
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
}

/// A place on a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinPlace {
    /// The triangle.
    pub triangle: usize,
    /// Where it is.
    pub position: DVec3,
    /// The normal there, smooth across the edges of triangles.
    pub normal: DVec3,
}

/// A groom on a mesh in its bind pose, in the unit of the mesh.
///
/// # Errors
/// A mesh that is not sound, a number outside of its range, fewer than one strand on all of the mesh.
pub fn grow(mesh: &SkinnedMesh, growth: &Growth) -> Result<HairAsset, GrowError> {
    mesh.check()?;
    growth.check()?;
    let places = roots(mesh, growth.density, growth.seed)?;
    let mut random = Pcg32::seed_from_u64(growth.seed ^ 1);
    let mut points = Vec::with_capacity(places.len() * growth.vertices as usize);
    for place in &places {
        growth.strand(place, &mut random, &mut points);
    }
    let counts = vec![growth.vertices; places.len()];
    Ok(HairAsset::new(format!("grown on {}", mesh.name), AssetFormat::TressFx4, points, counts))
}

/// Evenly spread places on a mesh, so many a square unit.
///
/// # Errors
/// As [`grow`].
pub fn roots(mesh: &SkinnedMesh, density: f64, seed: u64) -> Result<Vec<SkinPlace>, GrowError> {
    mesh.check()?;
    let corner = |corner: u32| mesh.positions[corner as usize].as_dvec3();
    // The area up to and with each triangle.
    let mut areas = Vec::with_capacity(mesh.triangles.len());
    let mut area = 0.0;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(corner);
        area += 0.5 * (b - a).cross(c - a).length();
        areas.push(area);
    }
    let wanted = density * area;
    if !(1.0..=MOST_STRANDS).contains(&wanted) {
        let (name, expected) = ("density times the area of the mesh", "from 1 to 2 million strands");
        return Err(GrowError::Number { name, value: wanted, expected });
    }
    let wanted = wanted.round() as usize;
    let normals = smooth_normals(mesh);
    let mut random = Pcg32::seed_from_u64(seed);
    let count = CANDIDATES * wanted;
    let candidate = |index: usize| {
        let at = area * (index as f64 + random.random::<f64>()) / count as f64;
        let triangle = areas.partition_point(|&until| until <= at).min(areas.len() - 1);
        let (one, other) = (random.random::<f64>().sqrt(), random.random::<f64>());
        let shares = [1.0 - one, one * (1.0 - other), one * other];
        let corners = mesh.triangles[triangle];
        let sum = |of: &[Vec3]| {
            corners.iter().zip(shares).map(|(&corner, share)| of[corner as usize].as_dvec3() * share).sum::<DVec3>()
        };
        SkinPlace { triangle, position: sum(&mesh.positions), normal: sum(&normals).normalize_or(DVec3::Y) }
    };
    let candidates: Vec<SkinPlace> = (0..count).map(candidate).collect();
    Ok(eliminate(&candidates, wanted, area))
}

/// Normals of vertices from all triangles at their place, by area. Vertices are often there several times, each with the normal of its own triangle,
/// and hair would part along every edge. A place where two sides meet with opposite normals keeps those of the mesh.
fn smooth_normals(mesh: &SkinnedMesh) -> Vec<Vec3> {
    let mut sums: HashMap<[u32; 3], Vec3> = HashMap::new();
    let place = |corner: u32| (mesh.positions[corner as usize] + Vec3::ZERO).to_array().map(f32::to_bits);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|&corner| *sums.entry(place(corner)).or_default() += normal);
    }
    let smooth = |(corner, &own): (usize, &Vec3)| {
        let sum = sums.get(&place(corner as u32)).copied().unwrap_or_default().normalize_or_zero();
        if sum.dot(own) > 0.0 { sum } else { own }
    };
    mesh.normals.iter().enumerate().map(smooth).collect()
}

impl Growth {
    fn check(&self) -> Result<(), GrowError> {
        let wrong = |name, value, expected| Err(GrowError::Number { name, value, expected });
        let share = |value: f32| (0.0..=1.0).contains(&value);
        match self {
            Self { density, .. } if !(*density > 0.0 && density.is_finite()) => wrong("density", *density, "above 0"),
            Self { length, .. } if !(*length > 0.0 && length.is_finite()) => {
                wrong("length", (*length).into(), "above 0")
            }
            Self { variation, .. } if !share(*variation) => wrong("variation", (*variation).into(), "from 0 to 1"),
            Self { lie, .. } if !share(*lie) => wrong("lie", (*lie).into(), "from 0 to 1"),
            Self { noise, .. } if !share(*noise) => wrong("noise", (*noise).into(), "from 0 to 1"),
            Self { comb, .. } if !comb.is_finite() => wrong("comb", f64::NAN, "finite"),
            Self { vertices, .. } if !(MIN_VERTICES..=MAX_VERTICES).contains(vertices) => {
                wrong("vertices", (*vertices).into(), "from 2 to 256")
            }
            _ => Ok(()),
        }
    }

    /// A strand that leaves the skin along its normal and bends to where it is combed.
    fn strand(&self, place: &SkinPlace, random: &mut Pcg32, points: &mut Vec<[f32; 3]>) {
        let mut signed = || random.random::<f64>() * 2.0 - 1.0;
        let shake = DVec3::new(signed(), signed(), signed()) * f64::from(self.noise);
        let shorter = 0.5 + 0.5 * signed();
        let normal = (place.normal + 0.5 * shake).normalize_or(place.normal);
        let comb = self.comb.as_dvec3();
        let flat = comb - normal * comb.dot(normal);
        let along = (flat.normalize_or_zero() + shake.reject_from_normalized(normal)).normalize_or_zero();
        let length = f64::from(self.length) * (1.0 - f64::from(self.variation) * shorter);
        let edges = f64::from(self.vertices - 1);
        let mut point = place.position;
        points.push(point.as_vec3().to_array());
        for edge in 0..self.vertices - 1 {
            let share = (f64::from(edge) + 0.5) / edges;
            // Most of the bend is near the root, as hair leaves its follicle.
            let down = f64::from(self.lie) * (1.0 - (1.0 - share) * (1.0 - share));
            let way = (normal * (1.0 - down) + along * down).normalize_or(normal);
            point += way * (length / edges);
            points.push(point.as_vec3().to_array());
        }
    }
}
