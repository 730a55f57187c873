//! Textures that are sampled, copied to from buffers, and written by compute passes.

use std::sync::Arc;

use tressfx_core::backend::{Blend, BufferDesc, ComputeDesc, Depth, Format};
use tressfx_core::error::{Error, Need};
use tressfx_core::id::TextureId;
use tressfx_core::pass::Load;
use tressfx_core::shader::{Sampler, Shader, ShaderSource, Specialization};

use super::formats::copied;
use super::kernels::LOAD;
use super::packed::encode;
use super::subject::{Subject, draw, noise, source};

/// Samples a picture at places.
const SAMPLE: ShaderSource = source(
    "suite.sample_at",
    "@group(0) @binding(0) var picture: texture_2d<f32>;
    @group(0) @binding(1) var how: sampler;
    @group(0) @binding(2) var<storage, read> places: array<vec2<f32>>;
    @group(0) @binding(3) var<storage, read_write> output: array<vec4<f32>>;
    @compute @workgroup_size(1) fn sample_at(@builtin(workgroup_id) i: vec3<u32>) {
        output[i.x] = textureSampleLevel(picture, how, places[i.x], 0.0);
    }",
);

/// The red channel of a picture at places, sampled in compute.
fn sampled(t: &mut Subject, picture: TextureId, sampler: Sampler, places: &[[f32; 2]]) -> Vec<f32> {
    let kernel = t.compute(&SAMPLE);
    let (at, output) = (t.storage(places), t.zeros(4 * places.len()));
    let bindings =
        [("picture", picture.into()), ("how", sampler.into()), ("places", at.into()), ("output", output.into())];
    t.dispatch(&kernel, &bindings, [places.len() as u32, 1, 1]);
    t.words(output, 4 * places.len()).chunks(4).map(|texel| f32::from_bits(texel[0])).collect()
}

/// Four texels by two: 0, 1, 0.5, 0.25 above, 1, 0, 0, 0 below.
fn chequer(t: &mut Subject) -> TextureId {
    let texels = [0.0f32, 1.0, 0.5, 0.25, 1.0, 0.0, 0.0, 0.0];
    let bytes: Vec<u8> = texels.iter().flat_map(|&red| encode(Format::Rgba16F, [red, 0.0, 0.0, 1.0])).collect();
    copied(t, Format::Rgba16F, [4, 2], &bytes)
}

#[track_caller]
fn assert_near(found: &[f32], expected: &[f32]) {
    // Devices weigh texels with eight bits.
    let near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() <= 1.0 / 256.0);
    assert!(near && found.len() == expected.len(), "{found:?} is not {expected:?}");
}

pub(super) fn nearest_takes_the_nearest_texel(t: &mut Subject) {
    let picture = chequer(t);
    let places = [[0.3, 0.2], [0.48, 0.3], [0.52, 0.3], [0.9, 0.4], [0.1, 0.8], [0.3, 0.6]];
    let found = sampled(t, picture, Sampler::Nearest, &places);
    assert_eq!(found, [1.0, 1.0, 0.5, 0.25, 1.0, 0.0]);
}

pub(super) fn linear_lies_between_texels(t: &mut Subject) {
    let picture = chequer(t);
    // Centres are at (i + 0.5) / 4 and (j + 0.5) / 2.
    let places = [[0.375, 0.25], [0.25, 0.25], [0.5, 0.25], [0.375, 0.5], [0.25, 0.5], [0.3125, 0.25]];
    let found = sampled(t, picture, Sampler::Linear, &places);
    assert_near(&found, &[1.0, 0.5, 0.75, 0.5, 0.5, 0.75]);
}

pub(super) fn samplers_clamp(t: &mut Subject) {
    let picture = chequer(t);
    let places = [[-3.0, -1.0], [1.0, 0.0], [1.5, 0.2], [0.0, 1.0], [-0.4, 7.0], [2.0, 2.0]];
    for sampler in [Sampler::Linear, Sampler::Nearest] {
        let found = sampled(t, picture, sampler, &places);
        assert_near(&found, &[0.0, 0.25, 0.25, 1.0, 1.0, 0.0]);
    }
}

pub(super) fn every_filterable_format_is_sampled(t: &mut Subject) {
    for format in Format::ALL.into_iter().filter(|format| format.is_filterable()) {
        let [black, white] = [[0.0; 4], [1.0; 4]].map(|color| encode(format, color));
        let picture = copied(t, format, [2, 1], &[black, white].concat());
        let found = sampled(t, picture, Sampler::Linear, &[[0.25, 0.5], [0.5, 0.5], [0.75, 0.5]]);
        assert_near(&found, &[0.0, 0.5, 1.0]);
    }
}

pub(super) fn fragments_sample(t: &mut Subject) {
    const SHRINK: ShaderSource = source(
        "suite.shrink",
        "import package::cover::cover;
        @group(0) @binding(0) var picture: texture_2d<f32>;
        @group(0) @binding(1) var how: sampler;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
        @fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
            return textureSample(picture, how, at.xy / vec2<f32>(2.0, 1.0));
        }",
    );
    let pipeline = t.raster(&SHRINK, &[(Format::Rgba16F, Blend::Replace)], Depth::Off);
    let picture = chequer(t);
    let target = t.texture([2, 1], Format::Rgba16F);
    let bindings = [("picture", picture.into()), ("how", Sampler::Linear.into())];
    t.draw(target, Load::Clear([9.0; 4]), vec![draw(&pipeline, &bindings, 3)]);
    let found = t.texels(target);
    let reds: Vec<f32> = found.chunks(8).map(|texel| half::f16::from_le_bytes([texel[0], texel[1]]).to_f32()).collect();
    assert_near(&reds, &[0.5, 0.1875]);
}

pub(super) fn rows_of_a_buffer_become_a_texture(t: &mut Subject) {
    for (size, format, offset, row_bytes) in [
        ([32, 3], Format::Rgba8, 0, 256),
        ([5, 4], Format::R32Uint, 8, 256),
        ([64, 2], Format::Rgba8, 264, 512),
        ([3, 5], Format::R16F, 16, 768),
        ([1, 1], Format::Rgba16F, 40, 256),
        ([65, 3], Format::R32F, 1000, 1024),
    ] {
        let row = size[0] as usize * format.bytes() as usize;
        let bytes: Vec<u8> = bytemuck::cast_slice(&noise(2048, size[0])).to_vec();
        let buffer = t.filled(&bytes, BufferDesc::storage);
        let texture = t.texture(size, format);
        t.list.copy_to_texture(buffer, offset as u64, row_bytes as u32, texture);
        // Of the source, only what was there before counts.
        t.list.clear(buffer, 0, 8192);
        let rows = (0..size[1] as usize).flat_map(|y| &bytes[offset + y * row_bytes..][..row]);
        let expected: Vec<u8> = rows.copied().collect();
        assert!(t.texels(texture) == expected, "{size:?} {format:?} from {offset}, {row_bytes} apart");
    }
}

pub(super) fn a_copy_replaces_what_was_drawn(t: &mut Subject) {
    let loader = t.compute(&LOAD);
    let texture = t.texture([32, 2], Format::Rgba8);
    let words = noise(64, 3);
    let (rows, output) = (t.zeros(128), t.zeros(64));
    t.list.upload(rows, 0, &words[..32]);
    t.list.upload(rows, 256, &words[32..]);
    t.draw(texture, Load::Clear([0.5; 4]), Vec::new());
    t.list.copy_to_texture(rows, 0, 256, texture);
    t.dispatch(&loader, &[("picture", texture.into()), ("output", output.into())], [1; 3]);
    t.draw(texture, Load::Keep, Vec::new());
    assert_eq!(t.texel_words(texture), words);
    assert_eq!(t.words(output, 64), words);
}

/// A kernel that writes a colour and its place into every texel of 8 x 4.
fn writer(format: &str, value: &str) -> ShaderSource {
    let text = format!(
        "@group(0) @binding(0) var picture: texture_storage_2d<{format}, write>;
        @compute @workgroup_size(8, 4) fn store(@builtin(local_invocation_id) at: vec3<u32>) {{
            textureStore(picture, at.xy, {value});
        }}"
    );
    source("suite.store", text.leak())
}

const STORED: &str = "vec4<f32>(vec2<f32>(at.xy) / 51.0, 0.2, 1.0)";

fn stored(x: u32, y: u32) -> [f32; 4] {
    [x as f32 / 51.0, y as f32 / 51.0, 0.2, 1.0]
}

fn written(t: &mut Subject, format: Format, name: &str, value: &str) -> TextureId {
    let kernel = t.compute(&writer(name, value));
    let picture = t.storage_texture([8, 4], format);
    t.dispatch(&kernel, &[("picture", picture.into())], [1; 3]);
    picture
}

pub(super) fn compute_writes_every_storage_format(t: &mut Subject) {
    for (format, name) in [(Format::Rgba8, "rgba8unorm"), (Format::Rgba16F, "rgba16float"), (Format::R32F, "r32float")]
    {
        assert!(format.is_storage());
        let picture = written(t, format, name, STORED);
        let found = t.texels(picture);
        for (i, texel) in found.chunks(format.bytes() as usize).enumerate() {
            let i = i as u32;
            super::formats::assert_rounds_to(format, texel, stored(i % 8, i / 8));
        }
    }
    let picture = written(t, Format::R32Uint, "r32uint", "vec4<u32>(at.x * 1000000000u + at.y, 1u, 2u, 3u)");
    let expected: Vec<u32> = (0..32u32).map(|i| (i % 8).wrapping_mul(1_000_000_000) + i / 8).collect();
    assert_eq!(t.texel_words(picture), expected);
}

pub(super) fn what_compute_writes_is_sampled_and_drawn_over(t: &mut Subject) {
    let picture = written(t, Format::Rgba16F, "rgba16float", STORED);
    let found = sampled(t, picture, Sampler::Nearest, &[[0.7, 0.1], [0.99, 0.9]]);
    assert_near(&found, &[5.0 / 51.0, 7.0 / 51.0]);
    t.draw(picture, Load::Clear([0.5; 4]), Vec::new());
    let again = t.compute(&writer("rgba16float", "vec4<f32>(2.0)"));
    let found = sampled(t, picture, Sampler::Nearest, &[[0.5, 0.5]]);
    assert_near(&found, &[0.5]);
    t.dispatch(&again, &[("picture", picture.into())], [1; 3]);
    assert_eq!(t.texels(picture), encode(Format::Rgba16F, [2.0; 4]).repeat(32));
}

/// Halves what a texel of 8 x 4 has, and adds its place and more, in steps of so much.
fn changer(format: &str, step: f32) -> ShaderSource {
    let text = format!(
        "@group(0) @binding(0) var picture: texture_storage_2d<{format}, read_write>;
        @compute @workgroup_size(8, 4) fn change(@builtin(local_invocation_id) at: vec3<u32>) {{
            let before = textureLoad(picture, at.xy);
            textureStore(picture, at.xy, 0.5 * before + {step:?} * vec4<f32>(vec2<f32>(at.xy), 32.0, 64.0));
        }}"
    );
    source("suite.change", text.leak())
}

pub(super) fn compute_changes_textures_in_place(t: &mut Subject) {
    if !t.backend.caps().read_write_textures {
        let shader = Arc::new(Shader::new(&changer("rgba16float", 1.0), &Specialization::new()).expect("a shader"));
        let refused = t.backend.create_compute(&ComputeDesc::new(shader));
        assert!(matches!(refused, Err(Error::Unsupported { need: Need::ReadWriteTextures, .. })), "{refused:?}");
        return;
    }
    // Steps that the format has, so that nothing is rounded on the way.
    let formats = [
        (Format::Rgba8, "rgba8unorm", 1.0 / 255.0),
        (Format::Rgba16F, "rgba16float", 1.0 / 256.0),
        (Format::R32F, "r32float", 1.0 / 256.0),
    ];
    for (format, name, step) in formats {
        let kernel = t.compute(&changer(name, step));
        let picture = t.storage_texture([8, 4], format);
        // Drawn to, changed by two passes of which one reads what the other writes, and drawn over again.
        t.draw(picture, Load::Clear([128.0 * step; 4]), Vec::new());
        t.dispatch(&kernel, &[("picture", picture.into())], [1; 3]);
        t.dispatch(&kernel, &[("picture", picture.into())], [1; 3]);
        t.draw(picture, Load::Keep, Vec::new());
        let found = t.texels(picture);
        for (i, texel) in found.chunks(format.bytes() as usize).enumerate() {
            // Half of 128, and more; half of that, and more again.
            let twice = |more: f32| step * (32.0 + 1.5 * more);
            let [x, y] = [i % 8, i / 8].map(|at| at as f32);
            super::formats::assert_rounds_to(format, texel, [twice(x), twice(y), twice(32.0), twice(64.0)]);
        }
    }
    let text = "@group(0) @binding(0) var picture: texture_storage_2d<r32uint, read_write>;
        @compute @workgroup_size(8, 4) fn count(@builtin(local_invocation_id) at: vec3<u32>) {
            textureStore(picture, at.xy, textureLoad(picture, at.xy) + vec4<u32>(1000000000u + at.x + 8u * at.y));
        }";
    let kernel = t.compute(&source("suite.count", text));
    let picture = t.storage_texture([8, 4], Format::R32Uint);
    for _ in 0..3 {
        t.dispatch(&kernel, &[("picture", picture.into())], [1; 3]);
    }
    let expected: Vec<u32> = (0..32u32).map(|i| (1_000_000_000 + i).wrapping_mul(3)).collect();
    assert_eq!(t.texel_words(picture), expected);
}

pub(super) fn integers_are_loaded(t: &mut Subject) {
    const LOAD_UINT: ShaderSource = source(
        "suite.load_uint",
        "@group(0) @binding(0) var picture: texture_2d<u32>;
        @group(0) @binding(1) var<storage, read_write> output: array<u32>;
        @compute @workgroup_size(8) fn load_uint(@builtin(local_invocation_index) i: u32) {
            output[i] = textureLoad(picture, vec2<u32>(i, 1u), 0).x;
        }",
    );
    let kernel = t.compute(&LOAD_UINT);
    let words = noise(16, 4);
    let bytes: &[u8] = bytemuck::cast_slice(&words);
    let picture = copied(t, Format::R32Uint, [8, 2], bytes);
    let output = t.zeros(8);
    t.dispatch(&kernel, &[("picture", picture.into()), ("output", output.into())], [1; 3]);
    assert_eq!(t.words(output, 8), words[8..]);
}
