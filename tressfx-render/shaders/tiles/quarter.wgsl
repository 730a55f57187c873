// A quarter of a tile: the pixels that a group of lanes blends.

import package::line::{Span, middle_of};

// Pixels along an edge.
const QUARTER: u32 = 4u;
const PIXELS: u32 = QUARTER * QUARTER;

// Rows of a mask become its columns.
fn transposed(mask: u32) -> u32 {
    let near = (mask ^ (mask >> 3u)) & 0x0a0au;
    let half = mask ^ near ^ (near << 3u);
    let far = (half ^ (half >> 6u)) & 0x00ccu;
    return half ^ far ^ (far << 6u);
}

// The pixels of the quarter from `corner` on that a span may touch, a bit each, row by row.
fn touched(span: Span, corner: vec2<u32>) -> u32 {
    let first = select(vec2<i32>(corner), vec2<i32>(corner.yx), span.steep);
    var mask = 0u;
    for (var i = 0; i < i32(QUARTER); i++) {
        let column = first.x + i;
        let middle = middle_of(span, column) - f32(first.y);
        let low = max(i32(ceil(middle - span.half_height)), 0);
        let high = min(i32(floor(middle + span.half_height)), i32(QUARTER) - 1);
        if column >= span.first_column && column <= span.last_column && low <= high {
            mask |= ((2u << u32(high)) - (1u << u32(low))) << (QUARTER * u32(i));
        }
    }
    return select(transposed(mask), mask, span.steep);
}
