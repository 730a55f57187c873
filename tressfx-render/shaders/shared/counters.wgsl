// What is counted of a view.

struct Counters {
    // Fragments that passed the depth test.
    fragments: atomic<u32>,
    // Of those, the ones that found no room in the pool.
    dropped: u32,
    // Pixels with at least one fragment.
    pixels_with_hair: atomic<u32>,
    // 1 where counting has ended at the limit.
    saturated: u32,
}
