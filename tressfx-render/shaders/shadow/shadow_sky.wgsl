// What arrives in each cell from everywhere, as a constant and a vector: from the direction `d` it is `w + v . d`. The ways of 26 directions
// to the neighbours of a cell are followed through the cells, and weighted as Lebedev's 26 points on a sphere. One thread a way.

import package::frames::{SKY, ShadowUniform};
import package::grid::{GROUP, thread_index};

@group(0) @binding(0) var<uniform> shadow: ShadowUniform;
@group(0) @binding(1) var<storage, read> cells: array<u32>;
// Four half floats a cell: the vector, the constant.
@group(0) @binding(2) var<storage, read_write> sky: array<vec2<u32>>;

const UNIT: f32 = 4096.0;
const SKIN: u32 = 0x80000000u;
const SKIN_DEPTH: f32 = 6.0;
// Beyond this nothing arrives.
const DARK: f32 = 9.0;
// The neighbours of a cell and the cell itself, and its number among them.
const WAYS: u32 = 27u;
const ITSELF: u32 = 13u;
const LANES_OF_A_CELL: u32 = 32u;
const CELLS_OF_A_GROUP: u32 = GROUP / LANES_OF_A_CELL;

// 1 for each cell of the group that is next to hair.
var<workgroup> near_hair: array<atomic<u32>, CELLS_OF_A_GROUP>;
// What arrives along each way.
var<workgroup> shares: array<f32, GROUP>;

// Weights of the faces, edges and corners of a cube.
fn weight_of(sides: i32) -> f32 {
    return select(select(9.0 / 280.0, 4.0 / 105.0, sides == 2), 1.0 / 21.0, sides == 1);
}

fn depth_of(cell: u32) -> f32 {
    return f32(cell & ~SKIN) / UNIT + select(0.0, SKIN_DEPTH, (cell & SKIN) != 0u);
}

fn depth_at(at: vec3<i32>) -> f32 {
    let size = i32(shadow.frames[SKY].size.x);
    return depth_of(cells[u32((at.z * size + at.y) * size + at.x)]);
}

fn is_inside(at: vec3<i32>) -> bool {
    return all(at >= vec3(0)) && all(at < vec3(i32(shadow.frames[SKY].size.x)));
}

fn passed(from_cell: vec3<i32>, step: vec3<i32>) -> f32 {
    let stride = length(vec3<f32>(step));
    var depth = 0.5 * depth_at(from_cell) * stride;
    for (var at = from_cell + step; is_inside(at) && depth < DARK; at += step) {
        depth += depth_at(at) * stride;
    }
    return depth;
}

// The step to a neighbour. The one in the middle of all 27 is the cell itself, and no way.
fn step_of(way: u32) -> vec3<i32> {
    return vec3<i32>(vec3(way % 3u, way / 3u % 3u, way / 9u)) - 1;
}

fn share_along(at: vec3<i32>, step: vec3<i32>) -> f32 {
    return weight_of(abs(step.x) + abs(step.y) + abs(step.z)) * exp(-passed(at, step));
}

// What arrives along all ways of a cell, whose shares begin there.
fn sum_from(first: u32) -> vec4<f32> {
    var arriving = vec4(0.0);
    for (var way = 0u; way < WAYS; way++) {
        if way != ITSELF {
            arriving += shares[first + way] * vec4(3.0 * normalize(vec3<f32>(step_of(way))), 1.0);
        }
    }
    return arriving;
}

@compute @workgroup_size(GROUP)
fn shadow_sky(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane) / LANES_OF_A_CELL;
    let size = shadow.frames[SKY].size.x;
    let at = vec3<i32>(vec3(i % size, i / size % size, i / (size * size)));
    let own = lane / LANES_OF_A_CELL;
    let way = lane % LANES_OF_A_CELL;
    let step = step_of(way);
    let is_way = i < size * size * size && way < WAYS;
    if way == 0u {
        atomicStore(&near_hair[own], 0u);
    }
    workgroupBarrier();
    // Light is asked for next to hair.
    if is_way && is_inside(at + step) && depth_at(at + step) > 0.0 {
        atomicStore(&near_hair[own], 1u);
    }
    workgroupBarrier();
    let is_asked = atomicLoad(&near_hair[own]) == 1u;
    if is_way && is_asked && way != ITSELF {
        shares[lane] = share_along(at, step);
    }
    workgroupBarrier();
    if is_way && way == 0u {
        var arriving = vec4(0.0, 0.0, 0.0, 1.0);
        if is_asked {
            arriving = sum_from(lane);
        }
        sky[i] = vec2(pack2x16float(arriving.xy), pack2x16float(arriving.zw));
    }
}
