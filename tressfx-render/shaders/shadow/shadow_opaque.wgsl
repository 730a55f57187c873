// The shadow of the opaque scene on strand vertices in the light of one light, from the depth that the light sees. One thread a vertex.

import package::grid::{GROUP, thread_index};
import package::ribbon::{is_sound, on_screen, scale_at};
import package::section::{SectionUniform, shaded_vertex};
import package::view::LensUniform;

struct OpaqueUniform {
    lens: LensUniform,
    // Pixels of the light's view, and where they begin in the texture.
    size: vec2<u32>,
    offset: vec2<u32>,
    // How much farther than the scene a point may be and still be lit.
    bias: f32,
    light: u32,
    unused: vec2<u32>,
}

@group(0) @binding(0) var<uniform> opaque_scene: OpaqueUniform;
@group(0) @binding(1) var depth: texture_depth_2d;
@group(0) @binding(2) var<uniform> section: SectionUniform;
@group(0) @binding(3) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> arriving: array<vec4<u32>>;

// Distance of the scene in a pixel, as far as anything where there is none.
fn scene_at(pixel: vec2<i32>) -> f32 {
    let inside = vec2<u32>(clamp(pixel, vec2(0), vec2<i32>(opaque_scene.size) - 1));
    let lens = opaque_scene.lens;
    let nearness = (textureLoad(depth, inside + opaque_scene.offset, 0) - lens.depth_offset) * lens.depth_scale;
    if lens.is_perspective == 0u {
        return (1.0 - nearness) / lens.nearness_slope;
    }
    return select(3e38, 1.0 / nearness, nearness > 0.0);
}

// The share of the light that arrives: four by four comparisons, weighted as a box of three by three pixels around the point.
fn lit_at(at: vec2<f32>, distance: f32) -> f32 {
    let middle = at - 0.5;
    let corner = vec2<i32>(floor(middle)) - 1;
    let share = middle - floor(middle);
    var sum = 0.0;
    for (var i = 0; i < 16; i++) {
        let step = vec2(i & 3, i >> 2u);
        let edge = select(select(vec2(1.0), share, step == vec2(3)), 1.0 - share, step == vec2(0));
        sum += edge.x * edge.y * select(0.0, 1.0, distance <= scene_at(corner + step) + opaque_scene.bias);
    }
    return sum / 9.0;
}

fn share_at(point: vec3<f32>) -> f32 {
    let lens = opaque_scene.lens;
    let at = (lens.to_eye * vec4(point, 1.0)).xyz;
    if -at.z <= lens.near {
        return 1.0;
    }
    let pixel = on_screen(lens, at.xy, scale_at(lens, -at.z));
    // What the light does not see is lit.
    if any(pixel < vec2(0.0)) || any(pixel > vec2<f32>(opaque_scene.size)) {
        return 1.0;
    }
    return lit_at(pixel, -at.z);
}

@compute @workgroup_size(GROUP)
fn shadow_opaque(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                 @builtin(local_invocation_index) lane: u32) {
    let thread = thread_index(group, groups, lane);
    if thread >= section.shaded_strands * section.lod.vertices {
        return;
    }
    let shaded = shaded_vertex(section.lod, section.shaded_strands, thread, section.vertices);
    let i = shaded.y * section.strands + shaded.x;
    if !is_sound(positions[i].xyz) {
        return;
    }
    let share = share_at((section.pose * vec4(positions[i].xyz, 1.0)).xyz);
    if share == 1.0 {
        return;
    }
    let word = 2u + opaque_scene.light / 4u;
    var roots = unpack4x8unorm(arriving[i][word]);
    roots[opaque_scene.light % 4u] *= sqrt(share);
    arriving[i][word] = pack4x8unorm(roots);
}
