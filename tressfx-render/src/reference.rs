//! The kernels in f64, on the CPU, and the picture that they approximate.
//!
//! Functions have the names of the kernels and take the view and the contents of the buffers, in their order. Nothing is rounded to half floats or to integers, except that a fragment too faint for the 16
//! bits of its alpha does not exist here either.

mod composite_compute;
mod coverage;
mod fill;
mod image;
mod joint;
mod nearest;
mod projection;
mod resolve;
mod ribbon;
mod scatter;
mod seen_keys;
mod seen_segments;
mod shade;
mod shadow;
mod shadow_bounds;
mod shadow_light;
mod shadow_opaque;
mod shadow_sky;
mod shadow_splat;
mod shadow_sum;
mod shortcut_colors;
mod shortcut_depths;
mod shortcut_resolve;
mod velocity;

use glam::{DMat4, DVec2, DVec3, DVec4};

use crate::copies::moved_aside;
use crate::lights::STORED_LIGHTS;
use crate::uniforms::SectionUniform;

pub use crate::scattering::FibreTable;
pub use composite_compute::composite_compute;
pub use coverage::{Stripe, coverage};
pub use fill::{Fragment, fill};
pub use image::{exact, resolved, resolved_at_places, resolved_with_tail, shortcut, supersampled};
pub use nearest::nearest;
pub use resolve::{resolve, resolve_at_places, resolve_with_tail};
pub use seen_keys::seen_keys;
pub use seen_segments::seen_segments;
pub use shade::shade;
pub use shadow::{ShadowCell, ShadowCells};
pub use shadow_bounds::shadow_bounds;
pub use shadow_light::{Shadows, shadow_light};
pub use shadow_opaque::shadow_opaque;
pub use shadow_sky::shadow_sky;
pub use shadow_splat::shadow_splat;
pub use shadow_sum::shadow_sum;
pub use shortcut_colors::shortcut_colors;
pub use shortcut_depths::{LayerPlace, Layers, shortcut_depths};
pub use shortcut_resolve::shortcut_resolve;
pub use velocity::velocity;

/// What arrives at a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arriving {
    /// Of light from everywhere, from the direction `d`, the share `w + (x, y, z) . d`.
    pub sky: DVec4,
    /// The shares of the first lights.
    pub lights: [f64; STORED_LIGHTS],
}

impl Arriving {
    /// All of it.
    pub const ALL: Self = Self { sky: DVec4::W, lights: [1.0; STORED_LIGHTS] };
}

/// The strands of a section on the CPU: what its buffers hold.
#[derive(Clone, Copy, Debug)]
pub struct Strands<'a> {
    /// Counts and material.
    pub uniform: SectionUniform,
    /// As [`StrandBuffers::positions`](tressfx_core::strand_buffers::StrandBuffers::positions).
    pub positions: &'a [[f32; 4]],
    /// As [`StrandBuffers::tangents`](tressfx_core::strand_buffers::StrandBuffers::tangents).
    pub tangents: &'a [[f32; 4]],
    /// What arrives at each vertex, in the order of the positions; none where nothing shades.
    pub arriving: Option<&'a [Arriving]>,
    /// What fibres that scatter as glass look up; none where the material has none.
    pub fibre: Option<&'a FibreTable>,
    /// As [`OwnLook::colors`](crate::OwnLook::colors).
    pub own_colors: Option<&'a [[f32; 4]]>,
    /// As [`StrandBuffers::thickness`](tressfx_core::strand_buffers::StrandBuffers::thickness).
    pub thickness: &'a [f32],
}

impl Strands<'_> {
    /// The vertex of the buffers that a drawn one is.
    fn full_vertex(&self, vertex: u32) -> u32 {
        (vertex * self.uniform.lod.step).min(self.uniform.vertices - 1)
    }

    /// Of a drawn vertex. A copy has that of its strand.
    fn index(&self, strand: u32, vertex: u32) -> usize {
        (self.full_vertex(vertex) * self.uniform.strands + strand % self.uniform.strands) as usize
    }

    /// The number of a drawn vertex, in the order of the positions, where there are no copies; among more strands where there are.
    fn number(&self, strand: u32, vertex: u32) -> u32 {
        self.full_vertex(vertex) * self.numbered_strands() + strand
    }

    fn numbered_strands(&self) -> u32 {
        self.uniform.strands.max(self.uniform.lod.strands)
    }

    /// Where a strand or a copy has a vertex of the whole strand, in the world.
    fn point_of(&self, strand: u32, full_vertex: u32) -> DVec3 {
        let of = &self.uniform;
        let local = xyz(&self.positions[(full_vertex * of.strands + strand % of.strands) as usize]);
        matrix(&of.pose).transform_point3(local + moved_aside(of.strands, strand, of.copy_spread))
    }

    /// The same of a drawn vertex.
    fn point(&self, strand: u32, vertex: u32) -> DVec3 {
        self.point_of(strand, self.full_vertex(vertex))
    }

    /// Whether anything is drawn from a drawn vertex.
    fn is_sound(&self, strand: u32, vertex: u32) -> bool {
        self.positions[self.index(strand, vertex)][..3].iter().all(|x| x.abs() < 1e12)
    }

    /// The vertex from which a segment leads to this one.
    fn before(&self, strand: u32, vertex: u32) -> Option<u32> {
        vertex.checked_sub(1).filter(|&before| self.is_sound(strand, before))
    }

    /// The vertex to which a segment leads from this one.
    fn after(&self, strand: u32, vertex: u32) -> Option<u32> {
        Some(vertex + 1).filter(|&after| after < self.uniform.lod.vertices && self.is_sound(strand, after))
    }

    /// Radius of the fibre at a vertex.
    fn radius(&self, strand: u32, vertex: u32) -> f64 {
        let lod = &self.uniform.lod;
        let fade = if strand + 1 == lod.strands { f64::from(lod.fade) } else { 1.0 };
        fade * self.full_radius(strand, vertex)
    }

    /// The same where no strand fades.
    fn full_radius(&self, strand: u32, vertex: u32) -> f64 {
        let of = &self.uniform;
        let share = f64::from(self.thickness[(self.full_vertex(vertex) * of.guides + strand % of.guides) as usize]);
        let tip = f64::from(of.tip_width);
        f64::from(of.fibre_radius) * (tip + (1.0 - tip) * share)
    }

    /// The position of a vertex of the buffers in the world: transformed by the pose of the section.
    pub fn posed(&self, index: usize) -> DVec3 {
        matrix(&self.uniform.pose).transform_point3(xyz(&self.positions[index]))
    }
}

fn matrix(columns: &[[f32; 4]; 4]) -> DMat4 {
    DMat4::from_cols_array_2d(&columns.map(|column| column.map(f64::from)))
}

fn xyz(v: &[f32; 4]) -> DVec3 {
    DVec4::from_array(v.map(f64::from)).truncate()
}

fn pair(v: [f32; 2]) -> DVec2 {
    DVec2::from_array(v.map(f64::from))
}
