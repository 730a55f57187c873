// The resolved hair lies over the picture, which a compute pass can read and write: a group a tile with hair, or several tiles where there are many.

import package::tile::{TILE, place_of_tile, resolved_index};
import package::view::ViewUniform;

@group(0) @binding(0) var<uniform> view: ViewUniform;
// Tiles with hair, and where their pixels are.
@group(0) @binding(1) var<storage, read> tiles: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> resolved: array<vec2<u32>>;
// Arguments of a draw: six vertices for each of the tiles.
@group(0) @binding(3) var<storage, read> drawn: array<u32, 4>;
@if(half_floats)
@group(0) @binding(4) var picture: texture_storage_2d<rgba16float, read_write>;
@if(!half_floats)
@group(0) @binding(4) var picture: texture_storage_2d<rgba8unorm, read_write>;

fn lay_over(slot: u32, pixel: vec2<u32>) {
    let packed = resolved[resolved_index(slot, pixel)];
    // Without hair the picture keeps what it has.
    if any(pixel >= view.size) || all(packed == vec2(0u)) {
        return;
    }
    let color = vec4(unpack2x16float(packed.x), unpack2x16float(packed.y));
    let place = pixel + view.offset;
    textureStore(picture, place, color + (1.0 - color.a) * textureLoad(picture, place));
}

@compute @workgroup_size(TILE, TILE)
fn composite_compute(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                     @builtin(local_invocation_id) lane: vec3<u32>) {
    let count = drawn[0] / 6u;
    for (var i = group.x; i < count; i += groups.x) {
        let listed = tiles[i];
        lay_over(listed.y, place_of_tile(listed.x, view.size) * TILE + lane.xy);
    }
}
