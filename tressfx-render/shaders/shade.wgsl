// The colour of each strand vertex. Shading in the space of the strands costs what the strands cost, however many pixels
// they cover and however often.

import package::grid::{GROUP, thread_index};
@if(!fibre) import package::lighting::{Fibre, scatter};
import package::ribbon::is_sound;
@if(fibre) import package::scattering::{Fibre, fibres, scatter, under_sky};
import package::section::{SectionUniform, stepped, strand_random};
import package::view::{STORED_LIGHTS, ViewUniform, towards, towards_eye};

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> section: SectionUniform;
@group(0) @binding(2) var<storage, read> positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> tangents: array<vec4<f32>>;
// Colour and opacity as four half floats.
@group(0) @binding(4) var<storage, read_write> colors: array<vec2<u32>>;
// As `shadow_light` leaves it.
@if(shadows) @group(0) @binding(5) var<storage, read> arriving: array<vec4<u32>>;
// What strands bring along, a vertex of every guide: linear RGB and opacity as four half floats.
@if(own_colors) @group(0) @binding(7) var<storage, read> own_colors: array<vec2<u32>>;

// Half floats end at 65504.
const BRIGHTEST: f32 = 60000.0;
// No colour is so dark that it has no logarithm.
@if(fibre && own_colors) const DARKEST: f32 = 1e-30;
// Less light than the smallest share that is told from none comes through no hair, and less light of the sky keeps its colour.
const DARK: f32 = 4e-6;
const DARKEST_SKY: f32 = 1e-3;

fn posed(i: u32) -> vec3<f32> {
    return (section.pose * vec4(positions[i].xyz, 1.0)).xyz;
}

fn unit(v: vec3<f32>) -> vec3<f32> {
    return v * inverseSqrt(max(dot(v, v), 1e-20));
}

// What arrives at a vertex: of light from everywhere from the direction `d` the share `sky.w + sky.xyz . d`, and the shares of the first lights.
struct Arriving {
    sky: vec4<f32>,
    lights: array<vec4<f32>, 2>,
}

@if(shadows)
fn arriving_at(i: u32) -> Arriving {
    let all = arriving[i];
    let roots = array(unpack4x8unorm(all.z), unpack4x8unorm(all.w));
    return Arriving(vec4(unpack2x16float(all.x), unpack2x16float(all.y)), array(roots[0] * roots[0], roots[1] * roots[1]));
}

@if(!shadows)
fn arriving_at(i: u32) -> Arriving {
    return Arriving(vec4(0.0, 0.0, 0.0, 1.0), array(vec4(1.0), vec4(1.0)));
}

// How much of a light arrives: as it is stored, or of what arrives from everywhere, from its direction.
fn share_of(shares: Arriving, light: u32, direction: vec3<f32>) -> f32 {
    if light < STORED_LIGHTS {
        return shares.lights[light / 4u][light % 4u];
    }
    let by_sky = saturate(shares.sky.w + dot(shares.sky.xyz, direction));
    return select(1.0, by_sky, ((view.casting >> light) & 1u) == 1u);
}

// The mean over all directions of the light from above and below that arrives.
fn around(open: vec4<f32>) -> vec3<f32> {
    let mean = 0.5 * (view.sky.rgb + view.ground.rgb);
    let slope = 0.5 * (view.sky.rgb - view.ground.rgb);
    return max(mix(mean, open.w * mean + open.y / 3.0 * slope, section.self_shadow), vec3(0.0));
}

fn lit(point: vec3<f32>, fibre: Fibre, i: u32) -> vec3<f32> {
    let eye = unit(towards_eye(view.eye, point));
    var shares = arriving_at(i);
    var sum = around(shares.sky);
    @if(!fibre) { sum *= fibre.albedo; }
    @if(fibre) {
        let open = clamp(mix(1.0, shares.sky.w, section.self_shadow), DARKEST_SKY, 1.0);
        sum *= under_sky(fibre, eye, fibres(open, section.shadow_alpha)) / open;
    }
    for (var light = 0u; light < view.light_count; light++) {
        let from_light = towards(view.lights[light], point);
        let share = mix(1.0, share_of(shares, light, from_light.xyz), section.self_shadow);
        @if(!fibre) { sum += view.lights[light].color.rgb * (from_light.w * share) * scatter(fibre, eye, from_light.xyz); }
        @if(fibre) {
            let behind = fibres(max(share, DARK), section.shadow_alpha);
            let arrives = select(from_light.w, 0.0, share < DARK);
            sum += view.lights[light].color.rgb * arrives * scatter(fibre, eye, from_light.xyz, behind);
        }
    }
    return sum;
}

// Where a vertex is on its strand, and how the strand differs from others: -1 to 1.
struct Place {
    // 0 at the root to 1 at the tip, and the share of the colour of the tip.
    along: f32,
    tip: f32,
    shade: f32,
    hue: f32,
}

fn place_of(strand: u32, guide: u32, vertex: u32) -> Place {
    let along = f32(vertex) / f32(section.vertices - 1u);
    let tip = saturate((along - section.tip_start) * section.tip_scale);
    var hue = 0.0;
    if section.hue_variation != 0.0 {
        hue = section.hue_variation * strand_random(strand, guide, 2u);
    }
    return Place(along, tip, strand_random(strand, guide, 0u), hue);
}

@if(!fibre)
fn fibre_at(tangent: vec3<f32>, tilt: f32, place: Place, own: vec4<f32>) -> Fibre {
    var albedo = mix(section.base, section.tip, place.tip).rgb;
    @if(own_colors) { albedo = mix(albedo, own.rgb, section.own_colors); }
    albedo *= (1.0 + section.variation * place.shade) * vec3(1.0 + place.hue, 1.0, 1.0 - place.hue);
    return Fibre(tangent, tilt, albedo, section.diffuse, section.primary, section.secondary);
}

@if(fibre)
fn fibre_at(tangent: vec3<f32>, tilt: f32, place: Place, own: vec4<f32>) -> Fibre {
    var absorption = mix(section.absorption, section.tip_absorption, place.tip).rgb;
    @if(own_colors) {
        let root = log(max(own.rgb, vec3(DARKEST)));
        absorption = mix(absorption, section.absorption.w * root * root, section.own_colors);
    }
    absorption *= (1.0 - section.variation * place.shade) * vec3(1.0 - place.hue, 1.0, 1.0 + place.hue);
    return Fibre(tangent, tilt, absorption, section.variance, section.multiple);
}

@if(own_colors)
fn own_at(guide: u32, vertex: u32) -> vec4<f32> {
    let color = own_colors[vertex * section.guides + guide];
    return vec4(unpack2x16float(color.x), unpack2x16float(color.y));
}

@if(!own_colors)
fn own_at(guide: u32, vertex: u32) -> vec4<f32> {
    return vec4(1.0);
}

// The guide that a strand follows. Guides themselves come first, and need no division.
fn guide_of(strand: u32) -> u32 {
    if strand < section.guides {
        return strand;
    }
    return strand % section.guides;
}

@compute @workgroup_size(GROUP)
fn shade(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>,
         @builtin(local_invocation_index) lane: u32) {
    let strand = thread_index(group, groups, lane);
    if strand >= section.shaded_strands {
        return;
    }
    let vertex = stepped(section.lod, group.z, section.vertices);
    let i = vertex * section.strands + strand;
    let guide = guide_of(strand);
    let place = place_of(strand, guide, vertex);
    let own = own_at(guide, vertex);
    let point = posed(i);
    let tangent = (section.pose * vec4(tangents[i].xyz, 0.0)).xyz;
    let tilt = section.tilt * (1.0 + section.tilt_variation * strand_random(strand, guide, 1u));
    let skin = mix(1.0 - section.root_shade, 1.0, smoothstep(0.0, section.root_extent, place.along));
    let fibre = fibre_at(tangent, tilt, place, own);
    let opacity = mix(section.base.a, section.tip.a, place.along) * own.a;
    var color = clamp(skin * lit(point, fibre, i), vec3(0.0), vec3(BRIGHTEST));
    if !is_sound(color) {
        color = vec3(0.0);
    }
    colors[i] = vec2(pack2x16float(color.rg), pack2x16float(vec2(color.b, opacity)));
}
