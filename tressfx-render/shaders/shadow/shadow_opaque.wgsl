// The shadow of the opaque scene on strand vertices in the light of those lights whose depth is in one texture. One thread a vertex.

import package::grid::{GROUP, thread_index};
import package::ribbon::{is_sound, on_screen, scale_at};
import package::section::{SectionUniform, shaded_vertex};
import package::view::{LensUniform, STORED_LIGHTS};

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

struct OpaqueScenesUniform {
    scenes: array<OpaqueUniform, STORED_LIGHTS>,
    count: u32,
    unused_0: u32,
    unused_1: u32,
    unused_2: u32,
}

@group(0) @binding(0) var<uniform> opaque_scenes: OpaqueScenesUniform;
@group(0) @binding(1) var depth: texture_depth_2d;
@group(0) @binding(2) var<uniform> section: SectionUniform;
@group(0) @binding(3) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> arriving: array<vec4<u32>>;

// Distance of a scene in a pixel, as far as anything where there is none.
fn scene_at(scene: u32, pixel: vec2<i32>) -> f32 {
    let inside = vec2<u32>(clamp(pixel, vec2(0), vec2<i32>(opaque_scenes.scenes[scene].size) - 1));
    let lens = opaque_scenes.scenes[scene].lens;
    let nearness = (textureLoad(depth, inside + opaque_scenes.scenes[scene].offset, 0) - lens.depth_offset) * lens.depth_scale;
    if lens.is_perspective == 0u {
        return (1.0 - nearness) / lens.nearness_slope;
    }
    return select(3e38, 1.0 / nearness, nearness > 0.0);
}

// The share of the light that arrives: four by four comparisons, weighted as a box of three by three pixels around the point.
fn lit_at(scene: u32, at: vec2<f32>, distance: f32) -> f32 {
    let middle = at - 0.5;
    let corner = vec2<i32>(floor(middle)) - 1;
    let share = middle - floor(middle);
    var sum = 0.0;
    for (var i = 0; i < 16; i++) {
        let step = vec2(i & 3, i >> 2u);
        let edge = select(select(vec2(1.0), share, step == vec2(3)), 1.0 - share, step == vec2(0));
        sum += edge.x * edge.y * select(0.0, 1.0, distance <= scene_at(scene, corner + step) + opaque_scenes.scenes[scene].bias);
    }
    return sum / 9.0;
}

fn share_at(scene: u32, point: vec3<f32>) -> f32 {
    let lens = opaque_scenes.scenes[scene].lens;
    let at = (lens.to_eye * vec4(point, 1.0)).xyz;
    if -at.z <= lens.near {
        return 1.0;
    }
    let pixel = on_screen(lens, at.xy, scale_at(lens, -at.z));
    // What the light does not see is lit.
    if any(pixel < vec2(0.0)) || any(pixel > vec2<f32>(opaque_scenes.scenes[scene].size)) {
        return 1.0;
    }
    return lit_at(scene, pixel, -at.z);
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
    let point = (section.pose * vec4(positions[i].xyz, 1.0)).xyz;
    let before = arriving[i].zw;
    var roots = array(unpack4x8unorm(before.x), unpack4x8unorm(before.y));
    for (var scene = 0u; scene < opaque_scenes.count; scene++) {
        let light = opaque_scenes.scenes[scene].light;
        roots[light / 4u][light % 4u] *= sqrt(share_at(scene, point));
    }
    let left = vec2(pack4x8unorm(roots[0]), pack4x8unorm(roots[1]));
    if any(left != before) {
        arriving[i] = vec4(arriving[i].xy, left);
    }
}
