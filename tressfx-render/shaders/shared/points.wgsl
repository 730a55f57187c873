// Vertices on the screen, and the tiles in which the segment between two of them may be seen, wherever its strand turns.

import package::ribbon::{End, is_sound, on_screen, scale_of};
import package::screen::{DISTANCE_MARGIN, nearness_at, view};
import package::tile::TILE;

// Coordinates in pixels up to which a vertex has its pixel: a ribbon between two such need not be cut to the screen.
const LARGEST_PIXEL: f32 = 32768.0;
// A point that nothing is drawn from.
const NOWHERE: vec4<f32> = vec4(3e38, 3e38, 3e38, 0.0);
// In more tiles than this it is not looked where a segment is hidden.
const MOST_TILES: i32 = 16;

// Pixel, nearness and radius / w of a vertex; where it is not beyond the near plane, or far outside of the picture, its point in the space of
// the eye and its radius below 0.
fn point_of(end: End) -> vec4<f32> {
    let distance = -end.point.z;
    let nearness = nearness_at(max(distance, view.lens.near));
    let scale = scale_of(view.lens, vec2(nearness)).x;
    let pixel = on_screen(view.lens, end.point.xy, scale);
    if distance <= view.lens.near || any(abs(pixel) >= vec2(LARGEST_PIXEL)) {
        return vec4(end.point, -max(end.radius, 1e-30));
    }
    return vec4(pixel, nearness, end.radius * scale);
}

// Pixels beside the line between two points within which a segment may leave fragments, its ends and turns included.
fn margin_between(a: vec4<f32>, b: vec4<f32>) -> f32 {
    let from_center = max(abs(a.xy - view.lens.center), abs(b.xy - view.lens.center));
    let focal = abs(view.lens.focal.x) + abs(view.lens.focal.y) + abs(view.lens.skew) + from_center.x + from_center.y;
    return 1.5 * (max(a.w, b.w) * focal + 1.0) + 1.0;
}

// Where a segment may be seen: in no pixel, in any, or in some tiles.
const IN_NONE: u32 = 0u;
const ANYWHERE: u32 = 1u;
const SOMEWHERE: u32 = 2u;

struct Reach {
    place: u32,
    // Larger than the nearness of all of its fragments.
    nearest: f32,
    // The first column and row of its tiles, and the last.
    low: vec2<i32>,
    high: vec2<i32>,
}

fn reach_between(a: vec4<f32>, b: vec4<f32>) -> Reach {
    var reach: Reach;
    if !is_sound(a.xyz) || !is_sound(b.xyz) {
        return reach;
    }
    let margin = margin_between(a, b);
    reach.place = ANYWHERE;
    if min(a.w, b.w) < 0.0 || any(max(abs(a.xy), abs(b.xy)) + margin >= vec2(LARGEST_PIXEL)) {
        return reach;
    }
    reach.low = vec2<i32>(floor(max(min(a.xy, b.xy) - margin, vec2(0.0)))) / i32(TILE);
    reach.high = vec2<i32>(floor(min(max(a.xy, b.xy) + margin, vec2<f32>(view.size) - 1.0))) / i32(TILE);
    if any(max(a.xy, b.xy) + margin < vec2(0.0)) || any(reach.low > reach.high) {
        reach.place = IN_NONE;
        return reach;
    }
    reach.nearest = max(a.z, b.z) * (1.0 + DISTANCE_MARGIN);
    if (reach.high.x - reach.low.x + 1) * (reach.high.y - reach.low.y + 1) <= MOST_TILES {
        reach.place = SOMEWHERE;
    }
    return reach;
}
