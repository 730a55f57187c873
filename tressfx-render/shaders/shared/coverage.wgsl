// How much of a pixel a strand covers.

// Area of a pixel on one side of a line, less one half: the pixel is a unit square whose projection across the line has
// the half-widths `reach.x` of its base and `reach.y` of its flat top, and the line passes at `distance` from its centre.
// Times `reach.x + reach.y`: one over the height of that trapezoid, whose area is 1.
fn side(distance: f32, reach: vec2<f32>) -> f32 {
    let x = abs(distance);
    let top = min(x, reach.y);
    let slope = max(reach.x - reach.y, 1e-6);
    let ramp = clamp(x - reach.y, 0.0, slope);
    return sign(distance) * (top + ramp - ramp * ramp * (0.5 / slope));
}

// The half-widths of a pixel seen across a line with the unit normal `normal`.
fn pixel_reach(normal: vec2<f32>) -> vec2<f32> {
    let n = abs(normal);
    return 0.5 * vec2(n.x + n.y, abs(n.x - n.y));
}

// Area of a pixel within `half_width` of a line that passes at `distance` from its centre: exact, so that what a strand
// covers in all is its width times its length, however thin it is.
fn coverage(distance: f32, half_width: f32, reach: vec2<f32>) -> f32 {
    return max(0.0, side(distance + half_width, reach) - side(distance - half_width, reach)) / (reach.x + reach.y);
}

// How high a round fibre rises before its axis where a pixel sees it: the root of the mean square of the height over what is covered of
// the pixel across.
fn rise_of(distance: f32, half_width: f32) -> f32 {
    let low = clamp(distance - 0.5, -half_width, half_width);
    let high = clamp(distance + 0.5, -half_width, half_width);
    let middle = 0.5 * (low + high);
    let width = high - low;
    return sqrt(max(half_width * half_width - middle * middle - width * width / 12.0, 0.0));
}

// The share of a pixel between two ends that are so far before and behind its centre. The pixel is as long as `length` along them.
fn between(before: f32, behind: f32, length: f32) -> f32 {
    return max(saturate(before / length + 0.5) + saturate(behind / length + 0.5) - 1.0, 0.0);
}
