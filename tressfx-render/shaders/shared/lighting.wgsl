// How a hair fibre scatters light: Kajiya and Kay's diffuse term and two highlights, shifted by the tilted scales of the
// cuticle (after Marschner's R and TRT).

struct Fibre {
    tangent: vec3<f32>,
    // Radians by which the scales tilt.
    tilt: f32,
    albedo: vec3<f32>,
    diffuse: f32,
    // Strength and exponent.
    primary: vec2<f32>,
    secondary: vec2<f32>,
}

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

// Radiance towards `eye` of a fibre in white light from `light`.
fn scatter(fibre: Fibre, eye: vec3<f32>, light: vec3<f32>) -> vec3<f32> {
    let along_light = dot(fibre.tangent, light);
    let along_eye = dot(fibre.tangent, eye);
    let primary = lobe(highlight(along_light, along_eye, 2.0 * fibre.tilt), fibre.primary);
    let secondary = lobe(highlight(along_light, along_eye, -3.0 * fibre.tilt), fibre.secondary);
    return fibre.albedo * (fibre.diffuse * perpendicular(along_light) + secondary) + primary;
}
