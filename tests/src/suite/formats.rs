//! Every format: cleared, drawn, sampled, loaded, copied and read back, against what the CPU makes of the colour.

use half::f16;
use tressfx_core::backend::{Blend, BufferDesc, Depth, DepthOrder, Format, TextureDesc, TextureUses};
use tressfx_core::error::{Error, Need};
use tressfx_core::pass::{Load, RasterPass};
use tressfx_core::shader::ShaderSource;

use super::kernels::LOAD;
use super::packed::{encode, steps};
use super::subject::{Subject, draw, source};

const COLORS: [[f32; 4]; 4] =
    [[0.2, 0.4, 0.6, 0.8], [0.0, 1.0, 0.003, 1.0], [0.735, 0.05, 0.91, 0.0], [0.5, 0.002, 0.25, 0.333]];

/// Texels of a colour that a format could round another way: one step a channel.
#[track_caller]
pub(super) fn assert_rounds_to(format: Format, found: &[u8], color: [f32; 4]) {
    let expected = encode(format, color);
    for (i, texel) in found.chunks(format.bytes() as usize).enumerate() {
        let pairs = steps(format, texel).into_iter().zip(steps(format, &expected));
        let near = pairs.into_iter().all(|(found, expected)| found.abs_diff(expected) <= 1);
        assert!(near, "{format:?} texel {i}: {color:?} is {expected:?}, not {texel:?}");
    }
}

/// Covers the target in a colour.
pub(super) const FILL: ShaderSource = source(
    "suite.fill",
    "import package::cover::cover;
    @group(0) @binding(0) var<uniform> color: vec4<f32>;
    @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
    @fragment fn fragment() -> @location(0) vec4<f32> { return color; }",
);

fn cleared_and_drawn(t: &mut Subject, format: Format) {
    let kernel = t.raster(&FILL, &[(format, Blend::Replace)], Depth::Off);
    let uses = TextureUses::TARGET | TextureUses::COPY_SOURCE;
    let desc = TextureDesc::new("suite.target", [5, 3], format).with_uses(uses);
    let target = t.backend.create_texture(&desc).expect("a target");
    for color in COLORS {
        t.draw(target, Load::Clear(color), Vec::new());
        let cleared = t.texels(target);
        assert_eq!(cleared.len() as u32, 15 * format.bytes());
        assert_rounds_to(format, &cleared, color);
        let uniform = t.uniform(&color);
        t.draw(target, Load::Clear([0.9; 4]), vec![draw(&kernel, &[("color", uniform.into())], 3)]);
        let drawn = t.texels(target);
        assert_rounds_to(format, &drawn, color);
    }
}

pub(super) fn new_textures_are_zero(t: &mut Subject) {
    for format in Format::ALL {
        let fresh = t.texture([65, 33], format);
        assert!(t.texels(fresh).iter().all(|&byte| byte == 0), "{format:?}");
    }
}

pub(super) fn rgba8(t: &mut Subject) {
    cleared_and_drawn(t, Format::Rgba8);
}

pub(super) fn rgba8_srgb(t: &mut Subject) {
    cleared_and_drawn(t, Format::Rgba8Srgb);
}

pub(super) fn bgra8(t: &mut Subject) {
    cleared_and_drawn(t, Format::Bgra8);
}

pub(super) fn bgra8_srgb(t: &mut Subject) {
    cleared_and_drawn(t, Format::Bgra8Srgb);
}

pub(super) fn rgba16f(t: &mut Subject) {
    cleared_and_drawn(t, Format::Rgba16F);
}

pub(super) fn rgb10a2(t: &mut Subject) {
    cleared_and_drawn(t, Format::Rgb10A2);
}

pub(super) fn r16f(t: &mut Subject) {
    cleared_and_drawn(t, Format::R16F);
}

pub(super) fn rg16f(t: &mut Subject) {
    cleared_and_drawn(t, Format::Rg16F);
}

pub(super) fn rg32f(t: &mut Subject) {
    cleared_and_drawn(t, Format::Rg32F);
}

pub(super) fn r32f(t: &mut Subject) {
    cleared_and_drawn(t, Format::R32F);
}

/// Not every device draws to it. One that does not says so in its caps, and refuses.
pub(super) fn r11g11b10f_is_drawn_to_or_refused(t: &mut Subject) {
    if t.backend.caps().r11g11b10_targets {
        return cleared_and_drawn(t, Format::R11G11B10F);
    }
    let desc = TextureDesc::new("suite.target", [5, 3], Format::R11G11B10F).with_uses(TextureUses::TARGET);
    let refused = t.backend.create_texture(&desc);
    let need = Need::Target(Format::R11G11B10F);
    assert!(matches!(refused, Err(Error::Unsupported { need: found, .. }) if found == need), "{refused:?}");
}

pub(super) fn r32_uint_is_cleared_and_drawn(t: &mut Subject) {
    const COUNT: ShaderSource = source(
        "suite.fill_uint",
        "import package::cover::cover;
        @group(0) @binding(0) var<uniform> word: vec4<u32>;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> { return cover(index); }
        @fragment fn fragment() -> @location(0) vec4<u32> { return word; }",
    );
    let kernel = t.raster(&COUNT, &[(Format::R32Uint, Blend::Replace)], Depth::Off);
    let target = t.texture([5, 3], Format::R32Uint);
    for number in [0u32, 7, 65_536, 1 << 24] {
        t.draw(target, Load::Clear([number as f32, 1.0, 2.0, 3.0]), Vec::new());
        assert_eq!(t.texel_words(target), [number; 15], "cleared");
    }
    for word in [1u32, u32::MAX, 0x8000_0001] {
        let uniform = t.uniform(&[word, 1, 2, 3]);
        t.draw(target, Load::Clear([9.0; 4]), vec![draw(&kernel, &[("word", uniform.into())], 3)]);
        assert_eq!(t.texel_words(target), [word; 15], "drawn");
    }
}

pub(super) fn rgba16f_holds_more_than_one_and_less_than_nothing(t: &mut Subject) {
    let target = t.texture([3, 3], Format::Rgba16F);
    let color = [1000.0, -2.5, 60_000.0, 1e-6];
    t.draw(target, Load::Clear(color), Vec::new());
    assert_rounds_to(Format::Rgba16F, &t.texels(target), color);
}

pub(super) fn depth32f(t: &mut Subject) {
    const AT_DEPTH: ShaderSource = source(
        "suite.at_depth",
        "import package::cover::cover;
        @group(0) @binding(0) var<uniform> depth: vec4<f32>;
        @vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
            return vec4<f32>(cover(index).xy, depth.x, 1.0);
        }
        @fragment fn fragment() {}",
    );
    let kernel = t.raster(&AT_DEPTH, &[], Depth::TestWrite(DepthOrder::Reverse));
    let target = t.texture([5, 3], Format::Depth32F);
    for depth in [0.25f32, 0.1, 1.0, 0.000_123] {
        let uniform = t.uniform(&[depth; 4]);
        for (load, draws) in [(depth, Vec::new()), (0.0, vec![draw(&kernel, &[("depth", uniform.into())], 3)])] {
            let mut pass = RasterPass::new("suite.depth").depth(target, Load::Clear(load));
            pass.draws = draws;
            t.list.raster(pass);
            let found: Vec<f32> = bytemuck::pod_collect_to_vec(&t.texels(target));
            assert!(found.len() == 15 && found.iter().all(|found| (found - depth).abs() < 1e-6), "{depth}: {found:?}");
        }
    }
}

pub(super) fn eight_bits_are_exact(t: &mut Subject) {
    let kernel = t.raster(&super::kernels::PAINT, &[(Format::Rgba8, Blend::Replace)], Depth::Off);
    let words: Vec<u32> = (0..256u32).flat_map(|i| [i | (255 - i) << 8 | i << 16 | i << 24; 4]).collect();
    let colors = t.storage(&words);
    let target = t.texture([32, 32], Format::Rgba8);
    t.draw(target, Load::Clear([0.0; 4]), vec![draw(&kernel, &[("colors", colors.into())], 3)]);
    assert_eq!(t.texel_words(target), words);
}

pub(super) fn what_is_loaded_is_linear_and_red_first(t: &mut Subject) {
    let kernel = t.compute(&LOAD);
    for format in [Format::Rgba8, Format::Rgba8Srgb, Format::Bgra8, Format::Bgra8Srgb, Format::Rgba16F] {
        let picture = t.texture([32, 2], format);
        let color = [0.5, 0.25, 0.75, 0.8];
        t.draw(picture, Load::Clear(color), Vec::new());
        let output = t.zeros(64);
        t.dispatch(&kernel, &[("picture", picture.into()), ("output", output.into())], [1; 3]);
        for texel in t.words(output, 64) {
            for (found, expected) in texel.to_le_bytes().into_iter().zip(color) {
                // A step of an sRGB texel is up to two of a linear one.
                assert!((f32::from(found) - 255.0 * expected).abs() <= 2.0, "{format:?}: {texel:08x} is not {color:?}");
            }
        }
    }
}

/// Loads the first texel.
const FIRST: ShaderSource = source(
    "suite.first",
    "@group(0) @binding(0) var picture: texture_2d<f32>;
    @group(0) @binding(1) var<storage, read_write> output: array<vec4<f32>>;
    @compute @workgroup_size(1) fn first() { output[0] = textureLoad(picture, vec2<u32>(0u), 0); }",
);

/// Every format that holds colours, filled by a copy: shaders read what was written, and what a format lacks as 0, alpha as 1.
pub(super) fn every_format_is_copied_to_and_loaded(t: &mut Subject) {
    let kernel = t.compute(&FIRST);
    let color = [0.2f32, 0.4, 0.8, 0.333];
    for format in Format::ALL.into_iter().filter(|format| !format.is_depth() && !format.is_uint()) {
        let texel = encode(format, color);
        let picture = copied(t, format, [3, 2], &texel.repeat(6));
        assert_eq!(t.texels(picture), texel.repeat(6), "{format:?} comes back as it went");
        let output = t.zeros(4);
        t.dispatch(&kernel, &[("picture", picture.into()), ("output", output.into())], [1; 3]);
        let found = t.words(output, 4).into_iter().map(f32::from_bits);
        let holds = match format {
            Format::R16F | Format::R32F => 1,
            Format::Rg16F | Format::Rg32F => 2,
            Format::R11G11B10F => 3,
            _ => 4,
        };
        for (c, found) in found.enumerate() {
            let expected = if c < holds { color[c] } else { f32::from(u8::from(c == 3)) };
            // Two bits of alpha; eight bits as sRGB are coarsest near white.
            let step = if format == Format::Rgb10A2 && c == 3 { 0.001 } else { 0.005 };
            let expected = if format == Format::Rgb10A2 && c == 3 { 1.0 / 3.0 } else { expected };
            assert!((found - expected).abs() < step, "{format:?}: channel {c} is {found}, not {expected}");
        }
    }
}

/// A texture that is filled through a buffer with rows 256 bytes apart or more.
pub(super) fn copied(t: &mut Subject, format: Format, size: [u32; 2], texels: &[u8]) -> tressfx_core::id::TextureId {
    let row = (size[0] * format.bytes()) as usize;
    let row_bytes = row.next_multiple_of(256);
    let mut rows = vec![0xee_u8; row_bytes * size[1] as usize];
    for (from, to) in texels.chunks(row).zip(rows.chunks_mut(row_bytes)) {
        to[..row].copy_from_slice(from);
    }
    let buffer = t.filled(&rows, BufferDesc::storage);
    let texture = t.texture(size, format);
    t.list.copy_to_texture(buffer, 0, row_bytes as u32, texture);
    texture
}

pub(super) fn rows_come_back_tight_whatever_the_width(t: &mut Subject) {
    for (width, format) in [1, 3, 31, 63, 64, 65, 127, 130]
        .into_iter()
        .flat_map(|width| [(width, Format::Rgba8), (width, Format::Rgba16F), (width, Format::R16F)])
    {
        let target = t.texture([width, 5], format);
        let color = [1.0, 0.0, 1.0, 1.0];
        t.draw(target, Load::Clear(color), Vec::new());
        assert_eq!(t.texels(target), encode(format, color).repeat(width as usize * 5), "{width} {format:?}");
    }
}

pub(super) fn halves_round_to_the_nearest(t: &mut Subject) {
    let target = t.texture([2, 2], Format::R16F);
    for value in [0.1f32, 1.0 / 3.0, 1234.5, 6e-8] {
        t.draw(target, Load::Clear([value; 4]), Vec::new());
        let found: Vec<u16> = bytemuck::pod_collect_to_vec(&t.texels(target));
        let expected = f16::from_f32(value).to_bits();
        assert!(found.iter().all(|found| found.abs_diff(expected) <= 1), "{value}: {found:x?} is not {expected:x}");
    }
}
