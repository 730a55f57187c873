//! Small shaders that several groups of cases use.

use tressfx_core::shader::ShaderSource;

use super::subject::source;

/// Adds one to every word, in groups of 64.
pub(super) const ADD_ONE: ShaderSource = source(
    "suite.add_one",
    "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
    @compute @workgroup_size(64) fn add_one(@builtin(global_invocation_id) i: vec3<u32>) { values[i.x] += 1u; }",
);

/// Changes every word in place, in groups of 64; not the same in any other order among additions.
pub(super) const TIMES_3_PLUS_1: ShaderSource = source(
    "suite.times_3_plus_1",
    "@group(0) @binding(0) var<storage, read_write> values: array<u32>;
    @compute @workgroup_size(64) fn times_3_plus_1(@builtin(global_invocation_id) i: vec3<u32>) {
        values[i.x] = values[i.x] * 3u + 1u;
    }",
);

/// Writes the words in reverse order and one more each, so that the first groups read what the last ones wrote before.
pub(super) const TURN: ShaderSource = source(
    "suite.turn",
    "@group(0) @binding(0) var<storage, read> input: array<u32>;
    @group(0) @binding(1) var<storage, read_write> output: array<u32>;
    @compute @workgroup_size(64) fn turn(@builtin(global_invocation_id) i: vec3<u32>) {
        output[i.x] = input[arrayLength(&input) - 1u - i.x] + 1u;
    }",
);

/// Covers the target in opaque white.
pub(super) const COVER: ShaderSource = source(
    "suite.cover",
    "import package::cover::cover;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
    @fragment fn fragment() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }",
);

/// Covers the target; each texel is a word of the buffer, row by row, in a target that is 32 wide. Read by the fragments.
pub(super) const PAINT: ShaderSource = source(
    "suite.paint",
    "import package::cover::cover;
    @group(0) @binding(0) var<storage, read> colors: array<u32>;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
    @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
        return unpack4x8unorm(colors[u32(at.y) * 32u + u32(at.x)]);
    }",
);

/// As [`PAINT`], read by the vertices: six for each texel.
pub(super) const PULL: ShaderSource = source(
    "suite.pull",
    "import package::cover::texel_corner;
    @group(0) @binding(0) var<storage, read> colors: array<u32>;
    struct Corner { @builtin(position) at: vec4<f32>, @location(0) @interpolate(flat) color: u32 }
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> Corner {
        let texel = index / 6u;
        let at = texel_corner(vec2<u32>(texel % 32u, texel / 32u), vec2<u32>(32u, 32u), index % 6u);
        return Corner(at, colors[texel]);
    }
    @fragment fn fragment(corner: Corner) -> @location(0) vec4<f32> { return unpack4x8unorm(corner.color); }",
);

/// Texels of a picture that is 32 wide become words.
pub(super) const LOAD: ShaderSource = source(
    "suite.load",
    "@group(0) @binding(0) var picture: texture_2d<f32>;
    @group(0) @binding(1) var<storage, read_write> output: array<u32>;
    @compute @workgroup_size(64) fn load(@builtin(global_invocation_id) i: vec3<u32>) {
        output[i.x] = pack4x8unorm(textureLoad(picture, vec2<u32>(i.x % 32u, i.x / 32u), 0));
    }",
);

/// What [`TURN`] makes of words.
pub(super) fn turned(words: &[u32]) -> Vec<u32> {
    words.iter().rev().map(|word| word.wrapping_add(1)).collect()
}

/// What [`TIMES_3_PLUS_1`] makes of words.
pub(super) fn stepped(words: &[u32]) -> Vec<u32> {
    words.iter().map(|word| word.wrapping_mul(3).wrapping_add(1)).collect()
}
