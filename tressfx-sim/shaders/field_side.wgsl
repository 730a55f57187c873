// On which side of an edge a line along z passes, in integers.

import package::field_mesh::build;

/// The place of a point across the lines, in parts of a cell.
fn part_of(point: vec3<f32>) -> vec2<i32> {
    return vec2<i32>(round(point.xy * f32(build.parts)));
}

/// Twice the area of the triangle between two vectors, positive where the second is to the left. Exact: coordinates are below 2^14.
fn twice_area(a: vec2<i32>, b: vec2<i32>) -> i32 {
    return a.x * b.y - a.y * b.x;
}

/// Whether the line is to the left of an edge from `a` to `b`, which are relative to the line. A line through the edge counts as if it were a
/// little further along y, and less along -x: to the left of an edge that goes along x, or straight along y.
fn is_left(a: vec2<i32>, b: vec2<i32>) -> bool {
    let area = twice_area(a, b);
    let is_forward = b.x > a.x || (b.x == a.x && b.y > a.y);
    return select(area > 0, is_forward, area == 0);
}
