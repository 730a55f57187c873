// The shadow of the opaque scene on strand vertices in the light of those lights whose depth is in one texture. One thread a vertex.

import package::grid::{GROUP, thread_index};
import package::ribbon::{is_sound, on_screen, scale_at};
import package::section::{SectionUniform, stepped};
import package::shares::{root_of_share, with_root};
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

// What the scene hides in a pixel: the nearness of what is there.
fn nearness_at(scene: u32, pixel: vec2<u32>) -> f32 {
    let seen = textureLoad(depth, pixel + opaque_scenes.scenes[scene].offset, 0);
    return (seen - opaque_scenes.scenes[scene].lens.depth_offset) * opaque_scenes.scenes[scene].lens.depth_scale;
}

// The nearness up to which what the scene has there leaves light for a point at this distance. All comparisons are with one number, and each takes no division.
fn nearest_to_pass(scene: u32, distance: f32) -> f32 {
    let lens = opaque_scenes.scenes[scene].lens;
    let least = distance - opaque_scenes.scenes[scene].bias;
    if lens.is_perspective == 0u {
        return 1.0 - lens.nearness_slope * least;
    }
    return select(3e38, 1.0 / least, least > 0.0);
}

// The share of the light that passes in four pixels of a row, weighted.
fn lit_in_row(scene: u32, columns: vec4<u32>, row: u32, weights: vec4<f32>, nearest: f32) -> f32 {
    let seen = vec4(
        nearness_at(scene, vec2(columns.x, row)),
        nearness_at(scene, vec2(columns.y, row)),
        nearness_at(scene, vec2(columns.z, row)),
        nearness_at(scene, vec2(columns.w, row)),
    );
    return dot(weights, select(vec4(0.0), vec4(1.0), seen <= vec4(nearest)));
}

// The share of the light that arrives: four by four comparisons, weighted as a box of three by three pixels around the point.
fn lit_at(scene: u32, at: vec2<f32>, distance: f32) -> f32 {
    let middle = at - 0.5;
    let corner = vec2<i32>(floor(middle)) - 1;
    let share = middle - floor(middle);
    let last = vec2<i32>(opaque_scenes.scenes[scene].size) - 1;
    let columns = vec4<u32>(clamp(corner.x + vec4(0, 1, 2, 3), vec4(0), vec4(last.x)));
    let rows = vec4<u32>(clamp(corner.y + vec4(0, 1, 2, 3), vec4(0), vec4(last.y)));
    let weights = vec4(1.0 - share.x, 1.0, 1.0, share.x);
    let nearest = nearest_to_pass(scene, distance);
    let sums = vec4(
        lit_in_row(scene, columns, rows.x, weights, nearest),
        lit_in_row(scene, columns, rows.y, weights, nearest),
        lit_in_row(scene, columns, rows.z, weights, nearest),
        lit_in_row(scene, columns, rows.w, weights, nearest),
    );
    return dot(sums, vec4(1.0 - share.y, 1.0, 1.0, share.y)) / 9.0;
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
    let strand = thread_index(group, groups, lane);
    if strand >= section.shaded_strands {
        return;
    }
    let vertex = stepped(section.lod, group.z, section.vertices);
    let i = vertex * section.strands + strand;
    if !is_sound(positions[i].xyz) {
        return;
    }
    let point = (section.pose * vec4(positions[i].xyz, 1.0)).xyz;
    let before = arriving[i].zw;
    var left = before;
    for (var scene = 0u; scene < opaque_scenes.count; scene++) {
        let light = opaque_scenes.scenes[scene].light;
        let root = root_of_share(left, light);
        // Where hair leaves nothing, the scene takes nothing.
        if root > 0.0 {
            left = with_root(left, light, root * sqrt(share_at(scene, point)));
        }
    }
    if any(left != before) {
        arriving[i] = vec4(arriving[i].xy, left);
    }
}
