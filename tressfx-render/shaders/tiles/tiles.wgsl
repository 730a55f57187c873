// Tiles of the screen, and slices of depth through them: what the kernels of this technique share.

import package::screen::view;

// Pixels along the edge of a tile.
const TILE: u32 = 8u;
// Slices of depth; each holds references to the segments that touch it.
const SLICES: u32 = 64u;
// Kinds of tiles by the number of their references, the heaviest last.
const CLASSES: u32 = 8u;
const MAX_SECTIONS: u32 = 64u;
// Quarters of a tile, row by row: each is blended by a group.
const QUARTERS: u32 = 4u;
// Bits of a reference: whether it comes from the nearest slice that the segment touches in the tile; whether the segment touches
// the first quarter of the tile, with those of the other quarters above; and the segment's first vertex.
const IS_NEAREST: u32 = 0x80000000u;
const FIRST_QUARTER: u32 = 0x08000000u;
const VERTEX_MASK: u32 = 0x07ffffffu;

struct TilesUniform {
    // Segments of all sections.
    segments: u32,
    // Sections that are drawn.
    sections: u32,
    // References that there is room for.
    capacity: u32,
    // 0 to count references, 1 to store them.
    stores: u32,
    // Distances between which hair is expected: the nearer one, and how much farther the other one is.
    nearest: f32,
    depth: f32,
    // Transmittance of a pixel below which nothing more is seen.
    closed_below: f32,
    // References of this round: the first one, and the one after the last with which a tile may begin.
    first: u32,
    end: u32,
    // References of all rounds.
    covered: u32,
    unused_0: u32,
    unused_1: u32,
    // Of each section: its first segment, its first vertex, its strands.
    layouts: array<vec4<u32>, MAX_SECTIONS>,
}

@group(0) @binding(1) var<uniform> tiles: TilesUniform;

// Groups in a row of the grid that blends tiles.
const ROW: u32 = 32768u;

// A tile with references.
struct WaitingTile {
    tile: u32,
    // The first reference.
    first: u32,
    // Nearness of the nearest vertex; 0 where there is none.
    nearest: f32,
    unused: u32,
}

// Tiles with references, by class.
struct Queue {
    // References that all tiles ask for.
    references: atomic<u32>,
    unused: array<u32, 3>,
    sizes: array<atomic<u32>, CLASSES>,
    // Room for all tiles in each class.
    tiles: array<WaitingTile>,
}

// The same where nothing is added any more.
struct WaitingTiles {
    references: u32,
    unused: array<u32, 3>,
    sizes: array<u32, CLASSES>,
    tiles: array<WaitingTile>,
}

fn tile_columns() -> u32 {
    return (view.size.x + TILE - 1u) / TILE;
}

fn tile_count() -> u32 {
    return tile_columns() * ((view.size.y + TILE - 1u) / TILE);
}

fn distance_of(nearness: f32) -> f32 {
    if view.lens.is_perspective == 1u {
        return 1.0 / nearness;
    }
    return (1.0 - nearness) / view.lens.nearness_slope;
}

fn nearness_at(distance: f32) -> f32 {
    if view.lens.is_perspective == 1u {
        return 1.0 / distance;
    }
    return 1.0 - view.lens.nearness_slope * distance;
}

// Where the slices of a tile begin: `nearness` is that of its nearest vertex, or 0 where there is none.
fn begin_of(nearness: f32) -> f32 {
    if nearness <= 0.0 {
        return tiles.nearest;
    }
    return clamp(distance_of(nearness), tiles.nearest, tiles.nearest + tiles.depth);
}

// The slice of a distance, from 0 to SLICES - 1, where the slices begin at `begin`. They are thin in front, where hair is seen,
// and grow. What lies before the first and behind the last belongs to them.
fn slice_of(begin: f32, distance: f32) -> u32 {
    let part = max(distance - begin, 0.0) / tiles.depth;
    return u32(min(f32(SLICES) * sqrt(part), f32(SLICES - 1u)));
}

// Where a slice begins.
fn slice_distance(begin: f32, slice: u32) -> f32 {
    let part = f32(slice) / f32(SLICES);
    return begin + part * part * tiles.depth;
}
