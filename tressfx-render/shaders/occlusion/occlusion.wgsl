// What hair hides of itself: tiles of the screen, and depths between which their hair becomes opaque. The kernels here share it.

struct OcclusionUniform {
    // Distances between which hair is expected: the nearer one, and how much farther the other one is.
    nearest: f32,
    depth: f32,
    // Bits of optical depth, -log2 of a transmittance, at which nothing more is seen.
    closing: f32,
    // Of so many strands the mass of one is taken.
    stride: u32,
}

@group(0) @binding(13) var<uniform> occlusion: OcclusionUniform;

// What is known of a tile; all are nearnesses.
struct OccludedTile {
    // Hair is expected to become opaque between these. The second is 0 where it is not dense.
    near: f32,
    far: f32,
    // What is behind it is not seen in any pixel of the tile.
    farthest: f32,
    unused: u32,
}

// Slices of depth for which the mass of hair in a tile is summed.
const SLICES: u32 = 64u;
// Of a sum of masses, in pixels times bits.
const MASS_UNIT: f32 = 256.0;
// Parts of the depth of a pixel: before `near`, and equal ones from there to `far`.
const PARTS: u32 = 4u;
// Of a sum of optical depths, in bits: as many fragments as a GPU can have at work do not make it overflow.
const BIT: f32 = 1024.0;
// Larger than any nearness.
const NEVER: f32 = 3e38;
// A share of a nearness: more than rounding can move a fragment out of its part.
const ROUNDING: f32 = 1e-6;

// The part in which a nearness is that is not behind the tile's last one.
fn part_of(tile: OccludedTile, nearness: f32) -> u32 {
    let share = (tile.near - nearness) / max(tile.near - tile.far, 1e-30);
    return select(1u + min(u32(share * f32(PARTS - 1u)), PARTS - 2u), 0u, nearness >= tile.near);
}

// The nearness at which a part ends: none of its fragments is behind it.
fn end_of_part(tile: OccludedTile, part: u32) -> f32 {
    return mix(tile.near, tile.far, f32(part) / f32(PARTS - 1u)) * (1.0 - ROUNDING);
}
