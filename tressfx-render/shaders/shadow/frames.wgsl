// Where fibres are counted for shadows: a box of cells as each light sees it, and one for the sky, whose axes are the world's.

import package::view::LightUniform;

// What a frame is.
const SKY: u32 = 0u;
const DIRECTIONAL: u32 = 1u;
const POINT: u32 = 2u;
// How the light of a light is found, where no frame is its own.
const OPEN: u32 = 0xffffffffu;
const BY_SKY: u32 = 0u;

struct ShadowFrameUniform {
    // World to the frame: the third axis is the way of the light.
    axes: mat4x4<f32>,
    // How many cells there are along each axis, and the first of them among the cells of all frames.
    size: vec3<u32>,
    first: u32,
    kind: u32,
    // Nearer to a point light than this nothing is told apart.
    nearest: f32,
    // Whether skin is behind roots.
    has_skin: u32,
    unused: u32,
}

struct ShadowUniform {
    lights: array<LightUniform, 16>,
    // The sky's, and those of lights.
    frames: array<ShadowFrameUniform, 9>,
    // The frame of each light, `BY_SKY` or `OPEN`, four to a vector.
    of_light: array<vec4<u32>, 4>,
    // Frames from `first` to before `end` are in use.
    first: u32,
    end: u32,
    // Strands of each section that are counted at most.
    samples: u32,
    // The largest radius of a fibre, in the unit of the positions.
    radius: f32,
}

// Cells of a frame in the world's or the light's axes.
struct ShadowGrid {
    low: vec3<f32>,
    cell: vec3<f32>,
    size: vec3<u32>,
    // Of all cells of all frames.
    first: u32,
}

// A point as a frame sees it: beside a point light x and y are tangents of angles.
fn in_frame(frame: ShadowFrameUniform, point: vec3<f32>) -> vec3<f32> {
    let at = (frame.axes * vec4(point, 1.0)).xyz;
    if frame.kind != POINT {
        return at;
    }
    let distance = max(at.z, frame.nearest);
    return vec3(at.xy / distance, distance);
}

// What the width of a fibre is divided by where a frame sees it from.
fn shrinks_by(frame: ShadowFrameUniform, at: vec3<f32>) -> f32 {
    return select(1.0, at.z, frame.kind == POINT);
}

// The next size of a cell up: four to each factor of two, so that cells stay as they are while hair moves a little.
fn step_up(size: f32) -> f32 {
    return exp2(ceil(4.0 * log2(size)) * 0.25);
}

// Whole numbers in the order of the numbers, and back.
fn order_of(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return bits ^ select(0x80000000u, 0xffffffffu, (bits >> 31u) == 1u);
}

fn number_of(order: u32) -> f32 {
    return bitcast<f32>(order ^ select(0xffffffffu, 0x80000000u, (order >> 31u) == 1u));
}

// The cells over a box that hair was found in. They stand still while the hair moves: their corner is at a multiple of their size.
fn grid_over(low: vec3<f32>, high: vec3<f32>, frame: ShadowFrameUniform, radius: f32) -> ShadowGrid {
    let extent = (high - low) / (vec3<f32>(frame.size) - 2.0);
    // A fibre is no wider than half a cell, and a cell is larger than what is lost by rounding.
    let far = max(abs(low), abs(high));
    let least = 4.0 * radius + 1e-6 * max(max(far.x, far.y), far.z) + 1e-20;
    let across = max(max(extent.x, extent.y), least / shrinks_by(frame, low));
    let along = max(extent.z, least);
    let cell = select(vec3(across, across, along), vec3(max(across, along)), frame.kind == SKY);
    let stepped = vec3(step_up(cell.x), step_up(cell.y), step_up(cell.z));
    let corner = (floor(0.5 * (low + high) / stepped) - floor(0.5 * vec3<f32>(frame.size))) * stepped;
    return ShadowGrid(corner, stepped, frame.size, frame.first);
}

// A place in cells.
fn place_in(grid: ShadowGrid, at: vec3<f32>) -> vec3<f32> {
    return clamp((at - grid.low) / grid.cell, vec3(-4.0), vec3<f32>(grid.size) + 4.0);
}

fn cell_at(grid: ShadowGrid, at: vec3<i32>) -> u32 {
    let inside = vec3<u32>(clamp(at, vec3(0), vec3<i32>(grid.size) - 1));
    return grid.first + (inside.z * grid.size.y + inside.y) * grid.size.x + inside.x;
}
