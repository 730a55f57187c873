// The engines' own last pass: from light without bounds to a picture. The target encodes sRGB.

@group(0) @binding(0) var light: texture_2d<f32>;

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the screen.
    return vec4(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

const KNEE = 0.8;

@fragment
fn develop(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let size = vec2<f32>(textureDimensions(light));
    let edge = length(at.xy / size - 0.5);
    let seen = textureLoad(light, vec2<i32>(at.xy), 0).rgb * (1.0 - 0.6 * edge * edge);
    // Highlights keep their shape: above the knee light is rolled off towards white.
    let over = KNEE + (1.0 - KNEE) * (1.0 - exp(-(seen - KNEE) / (1.0 - KNEE)));
    return vec4(select(seen, over, seen > vec3(KNEE)), 1.0);
}
