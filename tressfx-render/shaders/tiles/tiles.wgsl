// Tiles of the screen, and slices of depth through them: what the kernels of this technique share.

import package::screen::view;

// Pixels along the edge of a tile.
const TILE: u32 = 8u;
// Slices of depth; each holds references to the segments that touch it.
const SLICES: u32 = 64u;
// Kinds of tiles by the number of their references, the heaviest last.
const CLASSES: u32 = 16u;
const MAX_SECTIONS: u32 = 64u;

struct TilesUniform {
    // Segments of all sections.
    segments: u32,
    // Sections that are drawn.
    sections: u32,
    // References that there is room for.
    capacity: u32,
    // 0 to count references, 1 to store them.
    stores: u32,
    // Distance at which the first slice begins, and slices in a unit of distance.
    nearest: f32,
    slices_per_unit: f32,
    // Transmittance of a pixel below which nothing more is seen.
    closed_below: f32,
    unused: u32,
    // Of each section: its first segment, its first vertex, its strands.
    layouts: array<vec4<u32>, MAX_SECTIONS>,
}

// Groups in a row of the grid that blends tiles.
const ROW: u32 = 32768u;

// Tiles with references, by class. A tile is its number and its first reference.
struct Queue {
    // References that all tiles ask for.
    references: atomic<u32>,
    // Tiles of all classes.
    size: atomic<u32>,
    sizes: array<atomic<u32>, CLASSES>,
    // Room for all tiles in each class.
    tiles: array<vec2<u32>>,
}

// The same where nothing is added any more.
struct WaitingTiles {
    references: u32,
    size: u32,
    sizes: array<u32, CLASSES>,
    tiles: array<vec2<u32>>,
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

// The slice of a distance, from 0 to SLICES - 1. What lies before the first and behind the last belongs to them.
fn slice_of(tiles: TilesUniform, distance: f32) -> u32 {
    return u32(clamp((distance - tiles.nearest) * tiles.slices_per_unit, 0.0, f32(SLICES - 1u)));
}
