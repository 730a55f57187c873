// What a strand leaves in a pixel.

struct Fragment {
    color: vec3<f32>,
    // See the lens: larger is nearer.
    nearness: f32,
    // In units of 1 / 65535; 0 is no fragment.
    alpha: u32,
}

const OPAQUE: f32 = 65535.0;
