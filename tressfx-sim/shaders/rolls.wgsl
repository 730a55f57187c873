// How an edge rolls about itself, rad. The guess for a sub-step has a roll; both it and the one before are in 16 bits, and what is lost of them is lost
// of a guess alone.

import package::left::NORMAL;

struct Rolls {
    /// In the guess, and then in this sub-step so far.
    so_far: f32,
    /// In the sub-step before.
    last: f32,
}

/// No edge is rolled in a guess by more than this, rad.
const MOST_ROLL: f32 = 0.5;

fn packed_rolls(rolls: Rolls) -> f32 {
    return bitcast<f32>(pack2x16float(vec2(rolls.so_far, rolls.last)) + NORMAL);
}

fn rolls_of(packed: f32) -> Rolls {
    let rolls = unpack2x16float(bitcast<u32>(packed) - NORMAL);
    return Rolls(rolls.x, rolls.y);
}

fn rolls_back(rolls: Rolls) -> bool {
    return rolls.so_far * rolls.last < 0.0;
}

/// By how much an edge will roll that has rolled so: with the same acceleration, but not back. One that comes back, or that may not stay where it is, rolls on by
/// as much again; one that comes back twice in a row, and may stay, does.
fn rolled_on(rolls: Rolls, may_stay: bool, came_back: bool) -> f32 {
    let steady = 2.0 * rolls.so_far - rolls.last;
    let forth = select(0.0, steady, steady * rolls.so_far > 0.0);
    let back = select(rolls.so_far, 0.0, came_back);
    let next = select(rolls.so_far, select(forth, back, rolls_back(rolls)), may_stay);
    return select(next, 0.0, abs(next) > MOST_ROLL);
}
