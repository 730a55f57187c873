// The grid of a field: as many nodes as it has, around the box of the mesh and some cells more. One thread.

import package::field::{CELL, ORIGIN};
import package::field_mesh::{Grid, build};

@group(0) @binding(4) var<storage, read> extremes: array<u32, 6>;
@group(0) @binding(5) var<storage, read_write> new_grid: Grid;
@group(0) @binding(6) var<storage, read_write> all_fields: array<u32>;

/// Cells around the mesh.
const PADDING: f32 = 3.0;
/// A cell is no smaller than this share of the largest coordinate: below that rounding has no places between nodes,
const ROUNDING: f32 = 1e-5;
/// nor than this.
const SMALLEST: f32 = 1e-12;

@compute @workgroup_size(1)
fn field_grid() {
    var most = vec3(0.0);
    var least = vec3(0.0);
    if (extremes[0] != 0u) {
        most = number(vec3(extremes[0], extremes[1], extremes[2]));
        least = number(~vec3(extremes[3], extremes[4], extremes[5]));
    }
    let spaces = vec3<f32>(build.nodes) - 1.0;
    let sizes = (most - least) / (spaces - 2.0 * PADDING);
    let reach = max(abs(most), abs(least));
    let far = max(reach.x, max(reach.y, reach.z));
    let cell = max(max(sizes.x, max(sizes.y, sizes.z)), max(ROUNDING * far, SMALLEST));
    let origin = 0.5 * (least + most) - 0.5 * cell * spaces;
    new_grid = Grid(origin, cell);
    for (var axis = 0u; axis < 3u; axis++) { all_fields[build.header + ORIGIN + axis] = bitcast<u32>(origin[axis]); }
    all_fields[build.header + CELL] = bitcast<u32>(cell);
}

/// The number of an integer of `field_bounds`.
fn number(ordered: vec3<u32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(select(~ordered, ordered & vec3(0x7fffffffu), ordered >= vec3(0x80000000u)));
}
