// Opaque meshes beside the hair: heads, bodies, the capsules that hair collides with. Matte, with a soft edge of shadow.

@if(shadows) import package::hair_shadow::{hair_light, hair_sky};
import package::view::{ViewUniform, ambient, towards, towards_eye};

struct Surface {
    pose: mat4x4<f32>,
    color: vec4<f32>,
    // Strengths of the rim and of the highlight, the highlight's exponent, and how far light creeps into shadow.
    look: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: ViewUniform;
@group(0) @binding(1) var<uniform> surface: Surface;
// Position and normal of each vertex.
@group(0) @binding(2) var<storage, read> vertices: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> indices: array<u32>;

struct Varying {
    @builtin(position) position: vec4<f32>,
    @location(0) point: vec3<f32>,
    @location(1) normal: vec3<f32>,
}

@vertex
fn place(@builtin(vertex_index) i: u32) -> Varying {
    let vertex = indices[i];
    let point = (surface.pose * vec4(vertices[2u * vertex].xyz, 1.0)).xyz;
    let normal = (surface.pose * vec4(vertices[2u * vertex + 1u].xyz, 0.0)).xyz;
    return Varying(view.view_projection * vec4(point, 1.0), point, normal);
}

// What hair leaves of each light.
@if(shadows)
fn arriving_at(point: vec3<f32>) -> array<f32, 8> {
    let open = hair_sky(point);
    var shares = array<f32, 8>();
    for (var light = 0u; light < view.light_count; light++) {
        shares[light] = hair_light(light, point, open);
    }
    return shares;
}

@if(!shadows)
fn arriving_at(point: vec3<f32>) -> array<f32, 8> {
    return array(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0);
}

@fragment
fn scene(in: Varying) -> @location(0) vec4<f32> {
    let eye = normalize(towards_eye(view.eye, in.point));
    // Both sides are drawn, whatever the winding of the file.
    let outside = normalize(in.normal);
    let normal = select(-outside, outside, dot(outside, eye) >= -0.05);
    let rim = surface.look.x * pow(1.0 - saturate(dot(normal, eye)), 4.0);
    let wrap = surface.look.w;
    var shares = arriving_at(in.point);
    var sum = surface.color.rgb * ambient(view.sky, view.ground, normal);
    for (var i = 0u; i < view.light_count; i++) {
        let light = towards(view.lights[i], in.point);
        let facing = dot(normal, light.xyz);
        let diffuse = surface.color.rgb * saturate((facing + wrap) / (1.0 + wrap));
        let glint = pow(saturate(dot(normal, normalize(light.xyz + eye))), surface.look.z);
        let sheen = vec3(surface.look.y * glint * saturate(facing) + rim * saturate(facing + 0.3));
        sum += view.lights[i].color.rgb * light.w * shares[i] * (diffuse + sheen);
    }
    return vec4(sum, 1.0);
}
