// The resolved hair lies over the picture: six vertices for each tile with hair, in the order in which they were found.

import package::corner::corner_of_tile;
import package::tile::resolved_index;
import package::view::ViewUniform;

@if(hair_output)
import package::fragment::seen_nearness;

@group(0) @binding(0) var<uniform> view: ViewUniform;
// Tiles with hair, and where their pixels are.
@group(0) @binding(1) var<storage, read> tiles: array<vec2<u32>>;
@if(!hair_output)
@group(0) @binding(2) var<storage, read> resolved: array<vec2<u32>>;
// Three words a pixel: colour and alpha, and the key of the fragment whose depth the pixel has.
@if(hair_output)
@group(0) @binding(2) var<storage, read> resolved: array<u32>;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) slot: u32,
}

@vertex
fn tile_corner(@builtin(vertex_index) vertex: u32) -> Corner {
    let listed = tiles[vertex / 6u];
    let position = corner_of_tile(listed.x, vertex % 6u, view.size, view.offset, view.target_size);
    return Corner(position, listed.y);
}

@if(!hair_output)
@fragment
fn composite(corner: Corner) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(corner.position.xy) - view.offset;
    let color = resolved[resolved_index(corner.slot, pixel)];
    return vec4(unpack2x16float(color.x), unpack2x16float(color.y));
}

@if(hair_output)
struct Targets {
    @location(0) color: vec4<f32>,
    // Depth and coverage.
    @location(1) hair: vec4<f32>,
}

@if(hair_output)
@fragment
fn composite(corner: Corner) -> Targets {
    let pixel = vec2<u32>(corner.position.xy) - view.offset;
    let first = 3u * resolved_index(corner.slot, pixel);
    let color = vec4(unpack2x16float(resolved[first]), unpack2x16float(resolved[first + 1u]));
    // Without hair both targets keep what they have. The faintest hair may have a colour though its alpha is rounded to 0.
    if all(color == vec4(0.0)) {
        discard;
    }
    let depth = seen_nearness(resolved[first + 2u]) / view.lens.depth_scale + view.lens.depth_offset;
    return Targets(color, vec4(depth, color.a, 0.0, 0.0));
}
