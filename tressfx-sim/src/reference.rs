//! The kernels in f64 on the CPU, one strand at a time. Tests compare the results of the GPU with these.
//!
//! Every function does what the kernel of the same name does, with the same [`Step`]; [`follow_strand`] is the part of the
//! kernel `tangents` that places follow strands, and [`direct_guide`](direct::direct_guide) is what `direct` does. Arrays are strand-major, as in [`Strands`](tressfx_core::strands::Strands).

mod bone_roots;
pub mod direct;
mod direct_near;
pub mod field;
mod field_bounds;
mod field_crossings;
mod field_flood;
mod field_grid;
mod field_seed;
mod field_sign;
mod field_splat;
mod interpolate;
mod moved;
mod roots;
mod simulation;
mod skin;
mod surface_count;
mod surface_emit;
mod surface_scan;
mod tangents;
mod tressfx;
mod triangle_roots;
mod vector;
mod volume;
mod volume_nodes;
mod volume_push;
mod volume_splat;
mod wind;

use glam::{DVec3, Vec4};

use crate::step::Step;
use roots::RootMotion;

pub use bone_roots::bone_roots;
pub use direct_near::direct_near;
pub use field_bounds::field_bounds;
pub use field_crossings::field_crossings;
pub use field_flood::field_flood;
pub use field_grid::field_grid;
pub use field_seed::field_seed;
pub use field_sign::field_sign;
pub use field_splat::field_splat;
pub use interpolate::interpolate;
pub use moved::moved;
pub use roots::{GuideRoot, RootPlace, RootWay, roots};
pub use simulation::Simulation;
pub use skin::{skin, skin_tangents};
pub use surface_count::{NodeSurface, surface_count};
pub use surface_emit::surface_emit;
pub use surface_scan::surface_scan;
pub use tangents::{follow_strand, tangents};
pub use tressfx::tressfx;
pub use triangle_roots::triangle_roots;
pub use volume::{Moving, VolumeForces, rest_masses, vertex_masses, volume, volume_vertex};
pub use volume_nodes::{VolumeNode, volume_nodes};
pub use volume_push::volume_push;
pub use volume_splat::{VolumeSums, volume_splat};

/// One guide; a slice of each array of its section.
#[derive(Debug)]
pub struct Guide<'a> {
    /// Rest position relative to the centre of the groom, and inverse mass, of every vertex.
    pub rest: &'a [Vec4],
    /// Rest length of the edge from every vertex to the next one; 0 at the tip.
    pub rest_lengths: &'a [f32],
    /// Position of every vertex, relative to the centre of the groom.
    pub positions: &'a mut [DVec3],
    /// Position of every vertex one sub-step ago.
    pub previous: &'a mut [DVec3],
    /// The root, if it has a transform of its own.
    pub own_root: Option<GuideRoot>,
}

impl Guide<'_> {
    fn vertices(&self) -> usize {
        self.rest.len()
    }

    fn root(&self, step: &Step) -> RootMotion {
        RootMotion::new(step, self.own_root.as_ref())
    }

    fn inverse_mass(&self, vertex: usize) -> f64 {
        self.rest[vertex].w.into()
    }

    fn is_pinned(&self, vertex: usize) -> bool {
        self.rest[vertex].w == 0.0
    }
}
