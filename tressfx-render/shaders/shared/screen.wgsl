// The screen that strands are drawn on: the view, and the depth of the opaque scene.

import package::tile::TILE;
import package::view::ViewUniform;

@group(0) @binding(0) var<uniform> view: ViewUniform;
@if(!occluded)
@group(0) @binding(5) var scene_depth: texture_depth_2d;
// The nearness of what is seen farthest in each pixel of the view, hair that is opaque included: see `occlusion_depth`.
@if(occluded)
@group(0) @binding(5) var scene_depth: texture_2d<f32>;

// Share of a distance by which a ribbon is taken nearer than it is: more than rounding can move a fragment.
const DISTANCE_MARGIN: f32 = 4e-6;

// The nearness of the scene in a pixel of the view.
fn scene_nearness(pixel: vec2<u32>) -> f32 {
    @if(!occluded) {
        let depth = textureLoad(scene_depth, pixel + view.offset, 0);
        return (depth - view.lens.depth_offset) * view.lens.depth_scale;
    }
    @if(occluded) { return textureLoad(scene_depth, pixel, 0).x; }
}

fn distance_of(nearness: f32) -> f32 {
    if view.lens.is_perspective == 1u {
        return 1.0 / nearness;
    }
    return (1.0 - nearness) / view.lens.nearness_slope;
}

fn nearness_at(distance: f32) -> f32 {
    if view.lens.is_perspective == 1u {
        return 1.0 / distance;
    }
    return 1.0 - view.lens.nearness_slope * distance;
}

fn tile_columns() -> u32 {
    return (view.size.x + TILE - 1u) / TILE;
}

fn tile_count() -> u32 {
    return tile_columns() * ((view.size.y + TILE - 1u) / TILE);
}
