// What lies before the hair that comes next.

struct Front {
    color: vec3<f32>,
    transmittance: f32,
    // How many there are.
    fragments: u32,
}

const NOTHING: Front = Front(vec3(0.0), 1.0, 0u);

// What lies before what is behind so many fragments of one colour and opacity.
fn over(front: Front, color: vec3<f32>, alpha: f32, fragments: u32) -> Front {
    let next = front.color + front.transmittance * alpha * color;
    return Front(next, front.transmittance * (1.0 - alpha), front.fragments + fragments);
}
