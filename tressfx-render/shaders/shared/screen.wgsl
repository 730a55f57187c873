// The screen that strands are drawn on: the view, and the depth of the opaque scene.

import package::view::ViewUniform;

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(5) var scene_depth: texture_depth_2d;

// The nearness of the scene in a pixel of the view.
fn scene_nearness(pixel: vec2<u32>) -> f32 {
    let depth = textureLoad(scene_depth, pixel + view.offset, 0);
    return (depth - view.lens.depth_offset) * view.lens.depth_scale;
}
