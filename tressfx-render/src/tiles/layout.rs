//! How many vertices sections have for tiles, and how far from the eye they are.

use tressfx_core::error::{Error, Result};
use tressfx_core::gpu_struct;
use tressfx_core::pass::Grid;
use tressfx_core::view::View;

use super::Tiles;
use super::kernels::alloc_grid;
use crate::strands::SectionDraw;
use crate::uniforms::LodUniform;

/// Vertices that can be drawn together: a reference has 26 bits for one.
pub(crate) const MAX_VERTICES: u64 = 1 << 26;

/// Slices of depth.
pub(crate) const SLICES: u32 = 96;

/// Lanes of a group of `tile_points`.
const LANES: u32 = 256;

/// Segments of a piece of a strand, at most: see `tile_points.wgsl`, which has a bit for each of its vertices.
const MOST_SEGMENTS: u32 = 31;

/// How much further than at rest hair is expected from the middle of its section. What is further away still comes in its
/// order, with more work.
const SWING: f32 = 1.1;

gpu_struct! {
    /// What the kernels know of the segments and of the slices.
    pub(crate) struct TilesUniform {
        /// Vertices that there is room for.
        pub vertices: u32,
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
        /// References with which tiles begin in each of them but the last.
        pub window: u32,
        /// 1 where references leave out what hair has hidden in the frame before, else 0.
        pub skips_hidden: u32,
        /// Tiles whose resolved pixels have room.
        pub slots: u32,
        /// Tiles that are few: each of them is blended by more groups.
        pub few: u32,
        /// The number of the frame.
        pub frame: u32,
        /// References that are nearly too many for one round.
        pub crowd: u32,
        /// Groups of `tile_bin`, and nothing.
        pub bin_groups: [u32; 4],
        /// Groups of `tile_alloc`, and nothing.
        pub alloc_groups: [u32; 4],
    }
}

/// Vertices that sections take at most, with all their detail and where nothing hides them.
pub(crate) fn vertices(draws: &[SectionDraw]) -> u64 {
    let of = |draw: &SectionDraw| {
        let shape = draw.drawn_shape();
        kept(shape.strands(), shape.vertices)
    };
    draws.iter().map(of).sum()
}

/// Pieces of a strand with so many vertices.
fn pieces(vertices: u32) -> u32 {
    (vertices - 1).div_ceil(MOST_SEGMENTS)
}

/// Vertices of so many strands with so many each: two pieces have the one between them.
fn kept(strands: u32, vertices: u32) -> u64 {
    u64::from(strands) * u64::from(vertices + pieces(vertices) - 1)
}

/// The groups of `tile_points` for a section.
pub(crate) fn points_grid(draw: &SectionDraw) -> Grid {
    let LodUniform { strands, vertices, .. } = draw.lod_uniform();
    let pieces = pieces(vertices);
    let of_a_group = LANES / ((vertices - 1).div_ceil(pieces) + 1);
    Grid::for_threads(strands.div_ceil(of_a_group), 1).planes(pieces)
}

/// # Errors
/// If there are more vertices than can be drawn.
pub(crate) fn check(draws: &[SectionDraw]) -> Result<()> {
    let vertices = vertices(draws);
    if vertices > MAX_VERTICES {
        let message = format!("{vertices} vertices, tiles can draw {MAX_VERTICES}");
        return Err(Error::rule("hair.render.tiles", message));
    }
    Ok(())
}

/// What the kernels are given: for counting, and for storing in each round.
pub(crate) fn uniforms(view: &View, draws: &[SectionDraw], tiles: &Tiles, skips_hidden: bool) -> Vec<TilesUniform> {
    let (desc, memory) = (&tiles.desc, &tiles.memory);
    let references = &memory.references;
    let [nearest, farthest] = distances(view, draws);
    let uniform = |stores, round| TilesUniform {
        vertices: memory.vertices.count,
        capacity: references.capacity(round),
        stores,
        nearest,
        depth: farthest - nearest,
        closed_below: desc.closed_below,
        first: references.first(round),
        end: references.end(round),
        covered: references.covered(),
        rounds: references.rounds,
        window: references.window(),
        skips_hidden: skips_hidden.into(),
        slots: memory.screen.resolved.slots,
        few: tiles.few_tiles(),
        frame: tiles.frame,
        crowd: memory.crowd(),
        bin_groups: padded(memory.bin_grid(draws)),
        alloc_groups: padded(alloc_grid(view.size())),
    };
    let rounds = (0..references.rounds).map(|round| uniform(1, round));
    std::iter::once(uniform(0, 0)).chain(rounds).collect()
}

/// Vertices that sections take at most with the detail that they are drawn with.
pub(crate) fn drawn_vertices(draws: &[SectionDraw]) -> u64 {
    let of = |draw: &SectionDraw| {
        let lod = draw.lod_uniform();
        kept(lod.strands, lod.vertices)
    };
    draws.iter().map(of).sum()
}

fn padded(Grid([x, y, z]): Grid) -> [u32; 4] {
    [x, y, z, 0]
}

/// The distances from the plane of the eye between which the sections are expected; the second is larger.
pub(crate) fn distances(view: &View, draws: &[SectionDraw]) -> [f32; 2] {
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
