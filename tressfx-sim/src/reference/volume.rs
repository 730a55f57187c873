//! Hair against hair in f64: what its kernels share, and all of them in a sub-step.

use glam::{DVec3, Vec3};
use tressfx_core::strands::{Strands, relative_to};

use super::roots::RootMotion;
use super::vector::{position, rotate};
use super::{GuideRoot, VolumeNode, VolumeSums, volume_nodes, volume_push, volume_splat};
use crate::solver::Solver;
use crate::step::Step;
use crate::volume::{VolumeGrid, VolumeParams};

/// Half of the edges beside each vertex of the guides, for each strand that they stand for.
pub fn vertex_masses(strands: &Strands) -> Vec<f64> {
    let each = f64::from(1 + strands.follows);
    let of_strand = |lengths: &[f32]| -> Vec<f64> {
        let before = std::iter::once(0.0).chain(lengths.iter().copied());
        lengths.iter().zip(before).map(|(&after, before)| 0.5 * each * f64::from(before + after)).collect()
    };
    strands.rest_lengths.chunks(strands.vertices as usize).flat_map(of_strand).collect()
}

/// The mass that each node may have without pressure: what it has in the rest pose, or the mean that hair has around itself there times `rest_density`, if
/// that is more.
pub fn rest_masses(grid: &VolumeGrid, strands: &[&Strands], center: Vec3, rest_density: f32) -> Vec<f64> {
    let mut sums = VolumeSums::new(grid);
    for strands in strands {
        let rest = relative_to(center, &strands.rest);
        for (vertex, mass) in rest.iter().zip(vertex_masses(strands)) {
            volume_splat(grid, &mut sums, position(*vertex), mass, DVec3::ZERO);
        }
    }
    let masses: Vec<f64> = sums.0.iter().map(|sum| sum.w).collect();
    let (squares, whole) =
        masses.iter().fold((0.0, 0.0), |(squares, whole), mass| (squares + mass * mass, whole + mass));
    let mean = if whole > 0.0 { squares / whole } else { 0.0 };
    masses.iter().map(|mass| mass.max(f64::from(rest_density) * mean)).collect()
}

/// A vertex at the end of a sub-step as the grid sees it: its place in the space of the head, and its velocity relative to the head. `displacement` is
/// what its solver keeps.
pub fn volume_vertex(
    step: &Step,
    solver: Solver,
    own_root: Option<&GuideRoot>,
    here: DVec3,
    displacement: DVec3,
) -> (DVec3, DVec3) {
    let centre = step.center_displacement.as_dvec3();
    let with_head = here - step.carried_from(here);
    let surface = match solver {
        Solver::Direct => with_head,
        // It leaves the share of the root's motion out that the velocity shock has made.
        Solver::TressFx => {
            let with_root = here - RootMotion::new(step, own_root).carried_from(here) + centre;
            with_head - f64::from(step.shock) * with_root
        }
    };
    (step.in_head(here), step.in_head(displacement - surface) / f64::from(step.length))
}

/// What the kernels of hair against hair are told, in the unit of the file.
#[derive(Clone, Copy, Debug)]
pub struct VolumeForces {
    /// How fast compression spreads, units/s.
    pub sound_speed: f64,
    /// The rate at which velocities become those around them, 1/s.
    pub friction: f64,
    /// The speed that a faster vertex counts as, units/s.
    pub fastest: f64,
}

impl VolumeForces {
    /// Of a groom in this unit.
    pub fn new(params: &VolumeParams, metres_per_unit: f32) -> Self {
        let metres = f64::from(metres_per_unit);
        Self {
            sound_speed: f64::from(params.sound_speed) / metres,
            friction: params.friction.into(),
            fastest: f64::from(VolumeParams::FASTEST) / metres,
        }
    }
}

/// A vertex and what it counts.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    /// In the space of the head.
    pub place: DVec3,
    /// Relative to the head.
    pub velocity: DVec3,
    /// See [`vertex_masses`].
    pub mass: f64,
}

/// All kernels, one after the other: by what each vertex is displaced in a sub-step of `length` by the change of its velocity, in the space of the head.
pub fn volume(
    grid: &VolumeGrid,
    rest_masses: &[f64],
    forces: &VolumeForces,
    length: f64,
    vertices: &[Moving],
) -> Vec<DVec3> {
    let mut sums = VolumeSums::new(grid);
    let velocity = |vertex: &Moving| vertex.velocity.clamp_length_max(forces.fastest);
    for vertex in vertices {
        volume_splat(grid, &mut sums, vertex.place, vertex.mass, velocity(vertex));
    }
    let nodes: Vec<VolumeNode> = volume_nodes(grid, &sums, rest_masses);
    vertices.iter().map(|vertex| volume_push(grid, &nodes, forces, length, vertex.place, velocity(vertex))).collect()
}

/// The grid of a groom.
#[derive(Clone, Debug)]
pub(super) struct GroomVolume {
    grid: VolumeGrid,
    rest_masses: Vec<f64>,
    forces: VolumeForces,
    /// Of the vertices of each section.
    pub(super) masses: Vec<Vec<f64>>,
}

impl GroomVolume {
    pub(super) fn new(strands: &[&Strands], center: Vec3, params: &VolumeParams) -> Self {
        let grid = VolumeGrid::around(strands, center, params.cells);
        Self {
            grid,
            rest_masses: rest_masses(&grid, strands, center, params.rest_density),
            forces: VolumeForces::new(params, strands.first().map_or(1.0, |strands| strands.metres_per_unit)),
            masses: strands.iter().map(|strands| vertex_masses(strands)).collect(),
        }
    }

    pub(super) fn pushes(&self, length: f64, vertices: &[Moving]) -> Vec<DVec3> {
        volume(&self.grid, &self.rest_masses, &self.forces, length, vertices)
    }
}

/// From the space of the head to the axes of the world.
pub(super) fn to_world(step: &Step, push: DVec3) -> DVec3 {
    rotate(step.head_rotation.as_dvec4(), push)
}
