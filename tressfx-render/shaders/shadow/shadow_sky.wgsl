// What arrives in each cell from everywhere, as a constant and a vector: from the direction `d` it is `w + v . d`. The ways of 26 directions
// to the neighbours of a cell are followed through the cells, and weighted as Lebedev's 26 points on a sphere. One thread a cell.

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

// Whether light is asked for there: next to hair.
fn is_near_hair(at: vec3<i32>) -> bool {
    for (var i = 0; i < 27; i++) {
        let beside = at + vec3(i % 3, i / 3 % 3, i / 9) - 1;
        if is_inside(beside) && depth_at(beside) > 0.0 {
            return true;
        }
    }
    return false;
}

fn passed(from_cell: vec3<i32>, step: vec3<i32>) -> f32 {
    let stride = length(vec3<f32>(step));
    var depth = 0.5 * depth_at(from_cell) * stride;
    for (var at = from_cell + step; is_inside(at) && depth < DARK; at += step) {
        depth += depth_at(at) * stride;
    }
    return depth;
}

@compute @workgroup_size(GROUP)
fn shadow_sky(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
              @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    let size = shadow.frames[SKY].size.x;
    if i >= size * size * size {
        return;
    }
    let at = vec3<i32>(vec3(i % size, i / size % size, i / (size * size)));
    var arriving = vec4(0.0, 0.0, 0.0, 1.0);
    if is_near_hair(at) {
        arriving = vec4(0.0);
        for (var way = 0; way < 27; way++) {
            let step = vec3(way % 3, way / 3 % 3, way / 9) - 1;
            let sides = abs(step.x) + abs(step.y) + abs(step.z);
            if sides > 0 {
                let share = weight_of(sides) * exp(-passed(at, step));
                arriving += share * vec4(3.0 * normalize(vec3<f32>(step)), 1.0);
            }
        }
    }
    sky[i] = vec2(pack2x16float(arriving.xy), pack2x16float(arriving.zw));
}
