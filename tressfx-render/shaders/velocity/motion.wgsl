// How a section has moved on the screen of a view since the frame before.

struct MotionUniform {
    // From its positions to pixels of the viewport times w, and w: now, and for its past positions in the frame before.
    now: mat4x4<f32>,
    past: mat4x4<f32>,
    // The jitter of this frame less that of the frame before, pixels.
    jitter: vec2<f32>,
    // The number of its first segment in the frame.
    first: u32,
    unused: u32,
}
