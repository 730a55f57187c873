// How a strand goes on at a vertex, as the eye sees it.

// The tilt of a joint is the tangent of half the angle by which the strand turns there on the screen. Across a segment by one pixel, the
// bisector of the turn is so many pixels nearer to it. The pixels on either side of the bisector belong to either segment.
// Where the strand begins or ends, more than any of a joint:
const ROUND: f32 = 65024.0;
// At a larger tilt a segment ends round, where a strip up to the bisector would leave a spike.
const SHARP: f32 = 0.42;
const LARGEST: f32 = 1e3;
// Below this it is 0, and it has 6 bits behind its highest one: a half float without its four lowest bits, which no implementation rounds.
const LEAST: f32 = 6.103515625e-5;
const TILT_CUT: u32 = 17u;

// The tilt where one segment leads to another; both as they lie on the screen.
fn tilt_of(before: vec2<f32>, after: vec2<f32>) -> f32 {
    let lengths = sqrt(dot(before, before) * dot(after, after));
    let turn = before.x * after.y - before.y * after.x;
    return rounded_tilt(clamp(turn / max(lengths + dot(before, after), 1e-30), -LARGEST, LARGEST));
}

// All techniques divide the pixels of a strand alike, whether they store the tilt or not.
fn rounded_tilt(tilt: f32) -> f32 {
    let bits = ((bitcast<u32>(tilt) + (1u << (TILT_CUT - 1u))) >> TILT_CUT) << TILT_CUT;
    return select(bitcast<f32>(bits), 0.0, abs(tilt) < LEAST);
}
