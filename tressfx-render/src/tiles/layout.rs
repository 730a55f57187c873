//! Where the segments of all sections are, and how far from the eye.

use tressfx_core::error::{Error, Result};
use tressfx_core::gpu_struct;
use tressfx_core::pass::Grid;
use tressfx_core::view::View;

use super::Tiles;
use super::kernels::{alloc_grid, bin_grid};
use crate::strands::SectionDraw;

/// Sections that can be drawn together.
pub(crate) const MAX_SECTIONS: usize = 64;

/// Vertices that can be drawn together: a reference has 27 bits for one.
pub(crate) const MAX_VERTICES: u64 = 1 << 27;

/// Slices of depth.
pub(crate) const SLICES: u32 = 64;

/// The vertices of a section begin at a multiple of this, since ranges of bindings are aligned to 256 bytes.
const VERTEX_ALIGNMENT: u32 = 32;

/// How much further than at rest hair is expected from the middle of its section. What is further away still comes in its
/// order, with more work.
const SWING: f32 = 1.1;

gpu_struct! {
    /// What the kernels know of the segments and of the slices.
    pub(crate) struct TilesUniform {
        /// Segments of all sections.
        pub segments: u32,
        /// Sections that are drawn.
        pub sections: u32,
        /// References that there is room for.
        pub capacity: u32,
        /// 0 to count references, 1 to store them.
        pub stores: u32,
        /// Distance at which hair is expected to begin.
        pub nearest: f32,
        /// How much farther it is expected to end.
        pub depth: f32,
        /// Transmittance of a pixel below which nothing more is seen.
        pub closed_below: f32,
        /// The first reference of the round.
        pub first: u32,
        /// The one after the last with which a tile may begin in this round.
        pub end: u32,
        /// References of all rounds.
        pub covered: u32,
        /// How many there are.
        pub rounds: u32,
        /// References with which tiles begin in each of them.
        pub window: u32,
        /// 1 where references leave out what hair has hidden in the frame before, else 0.
        pub skips_hidden: u32,
        /// Tiles whose resolved pixels have room.
        pub slots: u32,
        /// Tiles that are few: each of them is blended by more groups.
        pub few: u32,
        /// Nothing.
        pub unused: u32,
        /// Groups of `tile_bin`, and nothing.
        pub bin_groups: [u32; 4],
        /// Groups of `tile_alloc`, and nothing.
        pub alloc_groups: [u32; 4],
        /// Of each section: its first segment, its first vertex, its strands that are drawn, nothing.
        pub layouts: [[u32; 4]; MAX_SECTIONS],
    }
}

/// Vertices that sections take at most, with all their detail, and what is left free between them.
pub(crate) fn vertices(draws: &[SectionDraw]) -> u64 {
    let of = |draw: &SectionDraw| {
        let shape = draw.drawn_shape();
        (u64::from(shape.strands()) * u64::from(shape.vertices)).next_multiple_of(VERTEX_ALIGNMENT.into())
    };
    draws.iter().map(of).sum()
}

/// Where the sections of a frame are.
#[derive(Debug)]
pub(crate) struct Layout {
    pub(crate) segments: u32,
    pub(crate) vertices: u64,
    pub(crate) first_vertices: Vec<u32>,
    sections: [[u32; 4]; MAX_SECTIONS],
}

impl Layout {
    /// # Errors
    /// If there are too many sections, or more vertices than can be counted.
    pub(crate) fn new(draws: &[SectionDraw]) -> Result<Self> {
        let rule = |message: String| Error::rule("hair.render.tiles", message);
        if draws.len() > MAX_SECTIONS {
            return Err(rule(format!("{} sections, tiles can draw {MAX_SECTIONS}", draws.len())));
        }
        let vertices = vertices(draws);
        if vertices > MAX_VERTICES {
            return Err(rule(format!("{vertices} vertices, tiles can draw {MAX_VERTICES}")));
        }
        let (mut segment, mut vertex) = (0, 0);
        let mut sections = [[0; 4]; MAX_SECTIONS];
        let mut first_vertices = Vec::new();
        for (section, draw) in sections.iter_mut().zip(draws) {
            *section = [segment, vertex, draw.lod_uniform().strands, 0];
            first_vertices.push(vertex);
            segment += draw.segments();
            vertex += draw.vertices().next_multiple_of(VERTEX_ALIGNMENT);
        }
        Ok(Self { segments: segment, vertices, first_vertices, sections })
    }

    /// What the kernels are given: for counting, and for storing in each round.
    pub(crate) fn uniforms(
        &self,
        view: &View,
        draws: &[SectionDraw],
        tiles: &Tiles,
        skips_hidden: bool,
    ) -> Vec<TilesUniform> {
        let (desc, memory) = (&tiles.desc, &tiles.memory);
        let references = &memory.references;
        let [nearest, farthest] = distances(view, draws);
        let uniform = |stores, [first, end]: [u32; 2]| TilesUniform {
            segments: self.segments,
            sections: draws.len() as u32,
            capacity: references.count,
            stores,
            nearest,
            depth: farthest - nearest,
            closed_below: desc.closed_below,
            first,
            end,
            covered: references.covered(),
            rounds: references.rounds,
            window: references.window(),
            skips_hidden: skips_hidden.into(),
            slots: memory.screen.resolved.slots,
            few: tiles.few_tiles(),
            unused: 0,
            bin_groups: padded(bin_grid(self.segments)),
            alloc_groups: padded(alloc_grid(view.size())),
            layouts: self.sections,
        };
        let rounds = (0..references.rounds).map(|round| uniform(1, references.round(round)));
        std::iter::once(uniform(0, [0, u32::MAX])).chain(rounds).collect()
    }
}

fn padded(Grid([x, y, z]): Grid) -> [u32; 4] {
    [x, y, z, 0]
}

/// The distances from the plane of the eye between which the sections are expected; the second is larger.
fn distances(view: &View, draws: &[SectionDraw]) -> [f32; 2] {
    let lens = view.lens();
    let of = |draw: &SectionDraw| {
        let (center, radius) = draw.sphere();
        let distance = -(lens.to_eye * draw.pose.matrix()).transform_point3(center).z;
        [distance - radius * SWING, distance + radius * SWING]
    };
    let both = |a: [f32; 2], b: [f32; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let [nearest, farthest] = draws.iter().map(of).reduce(both).unwrap_or_default();
    let nearest = nearest.max(lens.near);
    [nearest, farthest.max(nearest + nearest.abs() * 1e-3 + 1e-6)]
}
