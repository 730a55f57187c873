// What arrives at each strand vertex of the sky and of the first eight lights. One thread a vertex.

import package::view::STORED_LIGHTS;
import package::grid::{GROUP, thread_index};
import package::hair_shadow::{hair_light, hair_sky};
import package::ribbon::is_sound;
import package::section::{SectionUniform, stepped};

@group(0) @binding(0) var<uniform> section: SectionUniform;
@group(0) @binding(1) var<storage, read> positions: array<vec4<f32>>;
// The sky as four half floats, and the square roots of the shares of eight lights in bytes.
@group(0) @binding(2) var<storage, read_write> arriving: array<vec4<u32>>;

@compute @workgroup_size(GROUP)
fn shadow_light(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
                @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if strand >= section.shaded_strands {
        return;
    }
    let vertex = stepped(section.lod, group.z, section.vertices);
    let i = vertex * section.strands + strand;
    let local = positions[i].xyz;
    let point = (section.pose * vec4(select(vec3(0.0), local, is_sound(local)), 1.0)).xyz;
    let open = hair_sky(point);
    var roots = array<vec4<f32>, 2>();
    for (var light = 0u; light < STORED_LIGHTS; light++) {
        roots[light / 4u][light % 4u] = sqrt(hair_light(light, point, open));
    }
    let lights = vec2(pack4x8unorm(roots[0]), pack4x8unorm(roots[1]));
    arriving[i] = vec4(pack2x16float(open.xy), pack2x16float(open.zw), lights);
}
