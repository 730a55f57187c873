// Four places in a pixel. Light passes hair at each of them for itself, so that hair which lies behind the edge of a strand is seen
// beside it, and not through it.

// No two of them in a row or in a column: each stands for a quarter of the pixel across a line along either.
const PLACES_X: vec4<f32> = vec4(-0.125, 0.375, 0.125, -0.375);
const PLACES_Y: vec4<f32> = vec4(-0.375, -0.125, 0.375, 0.125);

// Each place's share within `half_width` of a line with the unit normal `normal` that passes at `distance` from the centre of the pixel.
fn shares_of(distance: f32, half_width: f32, normal: vec2<f32>) -> vec4<f32> {
    let reach = 0.125 * (abs(normal.x) + abs(normal.y));
    let across = distance + (PLACES_X * normal.x + PLACES_Y * normal.y);
    let most = min(half_width / reach, 1.0);
    return clamp((half_width + reach - abs(across)) * (0.5 / reach), vec4(0.0), vec4(most));
}

fn mean_of(places: vec4<f32>) -> f32 {
    return dot(places, vec4(0.25));
}

// Shares with the mean `covered`: all of them smaller by one factor, or what they leave free.
fn with_mean(shares: vec4<f32>, covered: f32) -> vec4<f32> {
    let mean = mean_of(shares);
    let grows = covered > mean;
    let factor = select(covered, 1.0 - covered, grows) / max(select(mean, 1.0 - mean, grows), 1e-6);
    return shares * factor + select(0.0, 1.0 - factor, grows);
}
