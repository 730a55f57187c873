// Tiles of the screen, and slices of depth through them: what the kernels of this technique share.

import package::screen::view;

// Pixels along the edge of a tile.
const TILE: u32 = 8u;
// Slices of depth; each holds references to the segments that touch it.
const SLICES: u32 = 64u;
// Ranges of the depth of the groom, alike in all tiles. In each tile they have as many slices as the hair in them needs.
const RANGES: u32 = 16u;
// Kinds of tiles by the number of their references, the heaviest last.
const CLASSES: u32 = 8u;
// Tiles of these classes and heavier ones are divided into 4 and into 16 parts, each for a group: one alone would take too long.
const CLASS_OF_4: u32 = 6u;
const CLASS_OF_16: u32 = 8u;
const MAX_SECTIONS: u32 = 64u;
// Set in a reference from the nearest slice that the segment touches in the tile. The other bits are the segment's first vertex.
const IS_NEAREST: u32 = 0x80000000u;

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
    // Vertices of a tile, of those that are sampled, behind which little is seen.
    layer: f32,
    // Of each section: its first segment, its first vertex, its strands.
    layouts: array<vec4<u32>, MAX_SECTIONS>,
}

@group(0) @binding(12) var<uniform> tiles: TilesUniform;

// Groups in a row of the grid that blends tiles.
const ROW: u32 = 32768u;

// Tiles with references, by class. A tile is its number and its first reference.
struct Queue {
    // References that all tiles ask for.
    references: atomic<u32>,
    // Groups that all tiles ask for.
    groups: atomic<u32>,
    unused: array<u32, 2>,
    sizes: array<atomic<u32>, CLASSES>,
    // Room for all tiles in each class.
    tiles: array<vec2<u32>>,
}

// The same where nothing is added any more.
struct WaitingTiles {
    references: u32,
    groups: u32,
    unused: array<u32, 2>,
    sizes: array<u32, CLASSES>,
    tiles: array<vec2<u32>>,
}

// Parts of a tile.
fn parts_of(load_class: u32) -> u32 {
    return select(select(1u, 4u, load_class >= CLASS_OF_4), 16u, load_class >= CLASS_OF_16);
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

// Where a distance is in the depth of the groom, in ranges: from 0 to RANGES.
fn in_ranges(distance: f32) -> f32 {
    return clamp((distance - tiles.nearest) / tiles.depth * f32(RANGES), 0.0, f32(RANGES));
}

// The slice of a distance that is in the range between `shares`, the shares of the slices before and up to the end of it.
fn slice_in(shares: vec2<f32>, part: f32) -> u32 {
    return u32(clamp(f32(SLICES) * mix(shares.x, shares.y, part), 0.0, f32(SLICES - 1u)));
}
