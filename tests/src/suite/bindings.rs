//! Parts of buffers that are bound.

use tressfx_core::backend::{Blend, BufferDesc, Depth, Format};
use tressfx_core::pass::Load;
use tressfx_core::shader::ShaderSource;

use super::formats::FILL;
use super::kernels::TURN;
use super::subject::{Subject, draw, noise, source};

/// Bytes from part to part: what the device asks for, and room for 64 words at least.
fn stride(t: &Subject) -> u64 {
    t.backend.caps().binding_alignment.max(256)
}

/// Words from part to part.
fn words_apart(t: &Subject) -> usize {
    stride(t) as usize / 4
}

pub(super) fn a_part_is_all_that_a_shader_sees(t: &mut Subject) {
    const SEEN: ShaderSource = source(
        "suite.seen",
        "@group(0) @binding(0) var<storage, read> part: array<u32>;
        @group(0) @binding(1) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(1) fn seen() {
            output[0] = arrayLength(&part);
            output[1] = part[0];
            output[2] = part[arrayLength(&part) - 1u];
        }",
    );
    let (kernel, apart) = (t.compute(&SEEN), words_apart(t));
    let words = noise(4 * apart, 1);
    let values = t.storage(&words);
    for (part, count) in [(0usize, 1usize), (1, apart), (2, 17), (3, apart)] {
        let output = t.zeros(3);
        let range = values.range(part as u64 * stride(t), 4 * count as u64);
        t.dispatch(&kernel, &[("part", range), ("output", output.into())], [1; 3]);
        let start = part * apart;
        assert_eq!(t.words(output, 3), [count as u32, words[start], words[start + count - 1]]);
    }
}

pub(super) fn parts_of_two_buffers_are_read_and_written(t: &mut Subject) {
    let (kernel, apart) = (t.compute(&TURN), words_apart(t));
    let words = noise(3 * apart, 2);
    let (input, output) = (t.storage(&words), t.storage(&vec![5u32; 3 * apart]));
    let part = |buffer: tressfx_core::id::BufferId, bytes| buffer.range(bytes, 256);
    let (from, to) = (part(input, 2 * stride(t)), part(output, stride(t)));
    t.dispatch(&kernel, &[("input", from), ("output", to)], [1; 3]);
    let mut expected = vec![5u32; 3 * apart];
    let turned = words[2 * apart..2 * apart + 64].iter().rev().map(|word| word.wrapping_add(1));
    expected.splice(apart..apart + 64, turned);
    assert_eq!(t.words(output, 3 * apart), expected, "and nothing beside it");
}

/// Writes what a uniform says.
const SET: ShaderSource = source(
    "suite.set_part",
    "@group(0) @binding(0) var<uniform> value: vec4<u32>;
    @group(0) @binding(1) var<storage, read_write> values: array<u32>;
    @compute @workgroup_size(64) fn set_part(@builtin(local_invocation_index) i: u32) { values[i] = value.x + value.w; }",
);

pub(super) fn one_uniform_buffer_serves_many_passes(t: &mut Subject) {
    let (kernel, apart) = (t.compute(&SET), words_apart(t));
    let mut words = vec![0u32; 20 * apart];
    (0..20).for_each(|i| words[i * apart..i * apart + 4].copy_from_slice(&[100 * i as u32, 0, 0, 7]));
    let uniforms = t.uniform(&words);
    let outputs: Vec<_> = (0..20).map(|_| t.zeros(64)).collect();
    for (i, &output) in outputs.iter().enumerate() {
        let value = uniforms.range(i as u64 * stride(t), 16);
        t.dispatch(&kernel, &[("value", value), ("values", output.into())], [1; 3]);
    }
    for (i, output) in outputs.into_iter().enumerate() {
        assert_eq!(t.words(output, 64), [100 * i as u32 + 7; 64], "pass {i}");
    }
}

pub(super) fn one_buffer_is_read_in_two_parts(t: &mut Subject) {
    const BOTH: ShaderSource = source(
        "suite.both_parts",
        "@group(0) @binding(0) var<storage, read> one: array<u32, 4>;
        @group(0) @binding(1) var<storage, read> other: array<u32, 4>;
        @group(0) @binding(2) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(4) fn both_parts(@builtin(local_invocation_index) i: u32) {
            output[i] = one[i] * 1000u + other[i];
        }",
    );
    let (kernel, apart) = (t.compute(&BOTH), words_apart(t));
    let words: Vec<u32> = (0..2 * apart as u32).collect();
    let (values, output) = (t.storage(&words), t.zeros(4));
    let parts = [values.range(stride(t), 16), values.range(0, 16)];
    t.dispatch(&kernel, &[("one", parts[0]), ("other", parts[1]), ("output", output.into())], [1; 3]);
    let expected: Vec<u32> = (0..4).map(|i| (apart as u32 + i) * 1000 + i).collect();
    assert_eq!(t.words(output, 4), expected);
}

pub(super) fn draws_are_given_parts(t: &mut Subject) {
    let pipeline = t.raster(&FILL, &[(Format::Rgba8, Blend::Add)], Depth::Off);
    let apart = words_apart(t);
    let mut colors = vec![0f32; 3 * apart];
    (0..3).for_each(|i| colors[i * apart + i] = 1.0);
    let colors = t.filled(&colors, BufferDesc::uniform);
    let target = t.texture([3, 3], Format::Rgba8);
    let layer = |t: &Subject, i: u64| draw(&pipeline, &[("color", colors.range(i * stride(t), 16))], 3);
    let layers = vec![layer(t, 0), layer(t, 2)];
    t.draw(target, Load::Clear([0.0; 4]), layers);
    assert_eq!(t.texel_words(target), [0x00ff_00ff; 9]);
}
