// Wind: each strand has its own, a mix of the directions of its cone, and feels the part of it that is across its edges.

import package::step::step;

/// A mix of the four corners of the wind's cone that is the strand's own. The weights sum to 1.
fn wind_of(strand: u32) -> vec3<f32> {
    let bits = scrambled(strand);
    let x = f32(bits & 0xffffu) / 65535.0;
    let y = f32(bits >> 16u) / 65535.0;
    return (step.wind[0].xyz * (1.0 - x) + step.wind[1].xyz * x) * (1.0 - y)
        + (step.wind[2].xyz * (1.0 - x) + step.wind[3].xyz * x) * y;
}

/// The `lowbias32` hash of Chris Wellons: neighbouring strands get unrelated winds.
fn scrambled(value: u32) -> u32 {
    var x = value;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

/// What of a wind acts on an edge of unit direction `edge`: the part across it.
fn across_edge(wind: vec3<f32>, edge: vec3<f32>) -> vec3<f32> {
    return wind - dot(wind, edge) * edge;
}
