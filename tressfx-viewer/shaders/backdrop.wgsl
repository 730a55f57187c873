// What is behind everything: a soft light in the middle, fading towards the edges.

struct Backdrop {
    middle: vec4<f32>,
    edge: vec4<f32>,
    size: vec2<f32>,
    far: f32,
    unused: f32,
}

@group(0) @binding(0) var<uniform> gradient: Backdrop;

@vertex
fn cover(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(vec2(i & 1u, i >> 1u)) * 4.0 - 1.0;
    return vec4(corner, gradient.far, 1.0);
}

@fragment
fn backdrop(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = (position.xy / gradient.size - vec2(0.5, 0.45)) * vec2(gradient.size.x / gradient.size.y, 1.0);
    let color = mix(gradient.middle, gradient.edge, smoothstep(0.0, 0.95, length(at)));
    // Jimenez' interleaved gradient noise, one step of 8 bits high: it hides the edges of those steps.
    let noise = fract(52.9829189 * fract(dot(floor(position.xy), vec2(0.06711056, 0.00583715)))) - 0.5;
    return vec4(color.rgb * (1.0 + 0.015 * noise), 1.0);
}
