// Blocks of tiles, where some are drawn again: most segments touch no block with such a tile, and are done with at once.

import package::screen::tile_columns;
import package::tile::TILE;

// Tiles along an edge of a block.
const BLOCK: u32 = 4u;
// Pixels along it.
const BLOCK_EDGE: u32 = BLOCK * TILE;

struct Blocks {
    // 1 where tiles are drawn again: before that, blocks know nothing.
    are_drawn_again: u32,
    words: array<u32>,
}

// The same while many groups come to a block.
struct SharedBlocks {
    are_drawn_again: atomic<u32>,
    words: array<atomic<u32>>,
}

fn block_at(place: vec2<u32>) -> u32 {
    return place.y * ((tile_columns() + BLOCK - 1u) / BLOCK) + place.x;
}

fn block_of(tile: u32) -> u32 {
    return block_at(vec2(tile % tile_columns(), tile / tile_columns()) / BLOCK);
}

// What a tile that is drawn again gives to its block, of which the block has the largest: the complement of the bits of the farthest nearness that is referred to.
// A block that no tile gave anything to has 0: it hides all.
fn block_word(farthest: f32) -> u32 {
    return select(0xffffffffu, ~bitcast<u32>(farthest), farthest > 0.0);
}

// Whether what is no nearer than this is hidden in all tiles of a block.
fn is_hidden_in(word: u32, nearness: f32) -> bool {
    // Numbers that are not negative are in the order of their bits; of a negative one they are larger than all.
    return bitcast<u32>(nearness) < ~word;
}
