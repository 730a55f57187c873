// What is counted of a view.

struct Counters {
    // Fragments that passed the depth test.
    fragments: atomic<u32>,
    // What found no room: fragments, or references; or that a group of tiles did not come to, see `turns`.
    dropped: atomic<u32>,
    // Pixels with at least one fragment.
    pixels_with_hair: atomic<u32>,
    // 1 where counting has ended at the limit.
    saturated: u32,
    // What was to be kept: fragments, or references.
    wanted: u32,
    // Tiles of 8 x 8 pixels with hair.
    tiles_with_hair: atomic<u32>,
    // What was merged for want of room. While lists are filled, the fragments that are not to have a node.
    merged: atomic<u32>,
    // Vertices that may be seen, of tiles.
    vertices: atomic<u32>,
}
