// The depth of opaque meshes as a light sees them.

import package::view::ViewUniform;

struct Surface {
    pose: mat4x4<f32>,
    color: vec4<f32>,
    look: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> surface: Surface;
@group(0) @binding(2) var<storage, read> vertices: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> indices: array<u32>;

@vertex
fn place(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    let point = surface.pose * vec4(vertices[2u * indices[i]].xyz, 1.0);
    return view.view_projection * vec4(point.xyz, 1.0);
}
