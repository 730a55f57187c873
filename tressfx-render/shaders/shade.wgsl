// The colour of each strand vertex. Shading in the space of the strands costs what the strands cost, however many pixels
// they cover and however often.

import package::grid::{GROUP, thread_index};
import package::lighting::{Fibre, scatter};
import package::ribbon::is_sound;
import package::section::{SectionUniform, strand_random};
import package::view::{ViewUniform, ambient, towards, towards_eye};

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> section: SectionUniform;
@group(0) @binding(2) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> tangents: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> visibility: array<vec4<f32>>;
// Colour and opacity as four half floats.
@group(0) @binding(5) var<storage, read_write> colors: array<vec2<u32>>;

// Half floats end at 65504.
const BRIGHTEST: f32 = 60000.0;

fn posed(i: u32) -> vec3<f32> {
    return (section.pose * vec4(positions[i].xyz, 1.0)).xyz;
}

fn unit(v: vec3<f32>) -> vec3<f32> {
    return v * inverseSqrt(max(dot(v, v), 1e-20));
}

// Where light comes from through the groom: a vector and a constant, from the frame of the strand. See `visibility.rs`.
fn visible_light(i: u32, strand: u32, tangent: vec3<f32>) -> vec4<f32> {
    let local = visibility[i / section.strands * section.guides + strand % section.guides];
    let growth = unit(posed(strand + section.strands) - posed(strand));
    // Where a strand grows straight on, there is no direction across: it fades.
    let side = growth - tangent * dot(growth, tangent);
    let across = side * min(inverseSqrt(max(dot(side, side), 1e-20)), 5.0);
    return vec4(local.x * tangent + local.y * across + local.z * cross(tangent, across), local.w);
}

fn lit(point: vec3<f32>, fibre: Fibre, open: vec4<f32>) -> vec3<f32> {
    let eye = unit(towards_eye(view.eye, point));
    let around = mix(1.0, saturate(open.w), section.self_shadow);
    var sum = around * ambient(view.sky, view.ground, unit(open.xyz)) * fibre.albedo;
    for (var i = 0u; i < view.light_count; i++) {
        let light = towards(view.lights[i], point);
        let arriving = light.w * mix(1.0, saturate(open.w + dot(open.xyz, light.xyz)), section.self_shadow);
        sum += view.lights[i].color.rgb * arriving * scatter(fibre, eye, light.xyz);
    }
    return sum;
}

@compute @workgroup_size(GROUP)
fn shade(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) lane: u32) {
    let i = thread_index(group, groups, lane);
    if i >= section.strands * section.vertices {
        return;
    }
    let strand = i % section.strands;
    let guide = strand % section.guides;
    let along = f32(i / section.strands) / f32(section.vertices - 1u);
    let point = posed(i);
    let tangent = (section.pose * vec4(tangents[i].xyz, 0.0)).xyz;
    let tilt = section.tilt * (1.0 + section.tilt_variation * strand_random(strand, guide, 1u));
    let paint = mix(section.base, section.tip, along);
    let albedo = paint.rgb * (1.0 + section.variation * strand_random(strand, guide, 0u));
    let skin = mix(1.0 - section.root_shade, 1.0, smoothstep(0.0, section.root_extent, along));
    let fibre = Fibre(tangent, tilt, albedo, section.diffuse, section.primary, section.secondary);
    var color = clamp(skin * lit(point, fibre, visible_light(i, strand, tangent)), vec3(0.0), vec3(BRIGHTEST));
    if !is_sound(color) {
        color = vec3(0.0);
    }
    colors[i] = vec2(pack2x16float(color.rg), pack2x16float(vec2(color.b, paint.a)));
}
