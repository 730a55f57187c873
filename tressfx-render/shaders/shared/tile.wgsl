// Tiles of the screen, row by row, and where their resolved pixels are.

// Pixels along the edge of a tile.
const TILE: u32 = 8u;

// The tile of a pixel, in a view of so many pixels.
fn tile_of(pixel: vec2<u32>, size: vec2<u32>) -> u32 {
    return pixel.y / TILE * ((size.x + TILE - 1u) / TILE) + pixel.x / TILE;
}

// The column and the row of a tile.
fn place_of_tile(tile: u32, size: vec2<u32>) -> vec2<u32> {
    let columns = (size.x + TILE - 1u) / TILE;
    return vec2(tile % columns, tile / columns);
}

// The place of a pixel among those that are resolved: `slot` is where those of its tile are.
fn resolved_index(slot: u32, pixel: vec2<u32>) -> u32 {
    return (slot * TILE + pixel.y % TILE) * TILE + pixel.x % TILE;
}
