// Tiles of the screen, and slices of depth through them: what the kernels of this technique share.

import package::counters::Counters;
import package::screen::distance_of;

// Slices of depth; each holds references to the segments that touch it.
const SLICES: u32 = 96u;
// Kinds of tiles by the number of their references, the heaviest last.
const CLASSES: u32 = 8u;
// Quarters of a tile, row by row: each is blended by a group.
const QUARTERS: u32 = 4u;
// Parts of a quarter, row by row, of 2 x 2 pixels. Where few tiles have hair, each is blended by a group, so that there are more groups,
// each of which has less to do one after the other.
const PARTS: u32 = 4u;
// A bit for each part of a tile, those of the first quarter first.
const ALL_PARTS: u32 = 0xffffu;
const PARTS_OF_A_QUARTER: u32 = 0xfu;
// A segment is referred to from the nearest slice that it touches in the tile, and from every second one behind it.
const STRIDE: u32 = 2u;
// Bits of a reference: whether it comes from the nearest slice; whether the segment touches the next slice too; whether it touches the
// first quarter of the tile, with those of the other quarters above; and the segment's first vertex.
const IS_NEAREST: u32 = 0x80000000u;
const REACHES_ON: u32 = 0x40000000u;
const FIRST_QUARTER: u32 = 0x04000000u;
const VERTEX_MASK: u32 = 0x03ffffffu;

struct TilesUniform {
    // Vertices and references that there is room for.
    vertices: u32,
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
    // Rounds, and the references with which tiles begin in each of them but the last.
    rounds: u32,
    window: u32,
    // 1 where references leave out what hair has hidden in the frame before.
    skips_hidden: u32,
    // Tiles whose resolved pixels have room.
    slots: u32,
    // Tiles that are few.
    few: u32,
    // The number of the frame.
    frame: u32,
    // References that are nearly too many for one round.
    crowd: u32,
    // The grids of `tile_bin` and `tile_alloc`.
    bin_groups: vec4<u32>,
    alloc_groups: vec4<u32>,
}

@group(0) @binding(12) var<uniform> tiles: TilesUniform;

// Groups in a row of the grid that blends tiles.
const ROW: u32 = 32768u;

// Grids of groups that `tile_alloc` counts, three numbers each: of `tile_blend`, and of `tile_bin` that stores, in each round.
const BLEND_GRID: u32 = 0u;
const STORE_GRIDS: u32 = 3u;
// Grids for tiles that are blended again: of `tile_bin` that counts, and of `tile_alloc`.
const COUNT_GRID: u32 = 0u;
const ALLOC_GRID: u32 = 3u;

// What is known of a tile.
struct TileInfo {
    // Nearness of the nearest vertex; 0 where there is none.
    nearest: f32,
    // Nearness of the farthest that is referred to, and of the farthest that the opaque scene shows. The first is larger where
    // hair has hidden what is behind it in the frame before.
    farthest: f32,
    scene: f32,
    // The first reference.
    first: u32,
    // A bit a part that is still to be blended.
    waiting: u32,
    // Where its resolved pixels are, and one; 0 until the tile is among those that the composite draws.
    slot: u32,
}

// The same while many groups come to a tile.
struct SharedTileInfo {
    nearest: atomic<u32>,
    farthest: f32,
    scene: f32,
    first: u32,
    waiting: atomic<u32>,
    slot: u32,
}

// What is kept of a tile from frame to frame.
struct KeptTile {
    // The complement of the bits of the nearness behind which its hair has hidden all; 0 where nothing is known of it.
    hidden: atomic<u32>,
    // Where the units of each quarter are to end, see `cuts`. It decides about speed alone, but where a group ends
    // early, see `turns`.
    cuts: array<atomic<u32>, QUARTERS>,
}

// What is kept of a view from frame to frame, behind its counters.
struct ViewState {
    counters: Counters,
    // The last frame in which a tile was drawn again.
    reopened: atomic<u32>,
    tiles: array<KeptTile>,
}

// Frames without a tile that is drawn again after which hair is taken to be at rest. (One such tile costs nearly as much as many: all vertices are looked through.)
const RESTLESS: u32 = 60u;

// Whether hair moves so that what it hid in a tile in the frame before may be seen there in this one.
fn is_restless(reopened: u32) -> bool {
    return tiles.frame - reopened < RESTLESS;
}

// The complement of the bits of nearness 0.
const NOTHING_HIDDEN: u32 = 0xffffffffu;

// Tiles with references, by class.
struct Queue {
    // References that all tiles ask for.
    references: atomic<u32>,
    // Tiles of all classes.
    size: atomic<u32>,
    unused: array<u32, 2>,
    sizes: array<atomic<u32>, CLASSES>,
    // Room for all tiles in each class.
    tiles: array<u32>,
}

// The same where nothing is added any more.
struct WaitingTiles {
    references: u32,
    size: u32,
    unused: array<u32, 2>,
    sizes: array<u32, CLASSES>,
    tiles: array<u32>,
}

// Groups that blend each of so many tiles.
fn groups_of_a_tile(count: u32) -> u32 {
    return select(QUARTERS, QUARTERS * PARTS, count <= tiles.few);
}

// Whether hair behind some nearness was left out, though the scene shows it.
fn is_cut(info: TileInfo) -> bool {
    return info.farthest > info.scene;
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
