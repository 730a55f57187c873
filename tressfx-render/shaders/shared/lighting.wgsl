// How a hair fibre scatters light: Kajiya and Kay's diffuse term and two highlights, shifted by the tilted scales of the
// cuticle (after Marschner's R and TRT).

import package::section::Section;

fn perpendicular(cosine: f32) -> f32 {
    return sqrt(max(0.0, 1.0 - cosine * cosine));
}

// Light that is mirrored into a cone whose axis is the fibre and whose angle is off by `shift`, seen from `eye`.
fn highlight(along_light: f32, along_eye: f32, shift: f32) -> f32 {
    let c = -along_light * cos(shift) - perpendicular(along_light) * sin(shift);
    return max(0.0, c * along_eye + perpendicular(c) * perpendicular(along_eye));
}

// A positive base only: pow is not defined elsewhere.
fn lobe(cosine: f32, term: vec2<f32>) -> f32 {
    return term.x * pow(max(cosine, 1e-6), term.y);
}

// Radiance towards `eye` of a fibre of colour `albedo` in white light from `light`.
fn scatter(section: ptr<uniform, Section>, tangent: vec3<f32>, eye: vec3<f32>, light: vec3<f32>, tilt: f32,
           albedo: vec3<f32>) -> vec3<f32> {
    let along_light = dot(tangent, light);
    let along_eye = dot(tangent, eye);
    let primary = lobe(highlight(along_light, along_eye, 2.0 * tilt), (*section).primary);
    let secondary = lobe(highlight(along_light, along_eye, -3.0 * tilt), (*section).secondary);
    return albedo * ((*section).diffuse * perpendicular(along_light) + secondary) + primary;
}

// How much a fibre of a thick head of hair turns towards a light: it stands for the shadow that the hair casts on itself.
fn form(section: ptr<uniform, Section>, normal: vec3<f32>, light: vec3<f32>) -> f32 {
    let wrapped = saturate((dot(normal, light) + 0.4) / 1.4);
    return mix(1.0, wrapped, (*section).form);
}
