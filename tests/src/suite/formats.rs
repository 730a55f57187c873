//! Every format, cleared, drawn and loaded, against what the CPU makes of the colour.

use half::f16;
use tressfx_core::backend::{Blend, Depth, DepthOrder, Format};
use tressfx_core::pass::{Load, RasterPass};
use tressfx_core::shader::ShaderSource;

use super::kernels::LOAD;
use super::subject::{Subject, draw, source};

const COLORS: [[f32; 4]; 4] =
    [[0.2, 0.4, 0.6, 0.8], [0.0, 1.0, 0.003, 1.0], [0.735, 0.05, 0.91, 0.0], [0.5, 0.002, 0.25, 0.333]];

/// A colour as the bytes of a texel.
pub(super) fn encode(format: Format, color: [f32; 4]) -> Vec<u8> {
    let [r, g, b, a] = color;
    let byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    let srgb = |value: f32| byte(to_srgb(value));
    match format {
        Format::Rgba8 => [r, g, b, a].map(byte).to_vec(),
        Format::Rgba8Srgb => vec![srgb(r), srgb(g), srgb(b), byte(a)],
        Format::Bgra8 => [b, g, r, a].map(byte).to_vec(),
        Format::Bgra8Srgb => vec![srgb(b), srgb(g), srgb(r), byte(a)],
        Format::Rgba16F => color.iter().flat_map(|&value| f16::from_f32(value).to_le_bytes()).collect(),
        Format::Depth32F => r.to_le_bytes().to_vec(),
    }
}

fn to_srgb(value: f32) -> f32 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// Bytes of a colour that a format could round another way: one step a channel.
pub(super) fn assert_rounds_to(format: Format, found: &[u8], color: [f32; 4]) {
    for (i, texel) in found.chunks(format.bytes() as usize).enumerate() {
        let expected = encode(format, color);
        let steps = |bytes: &[u8]| match format {
            Format::Rgba16F => bytes.chunks(2).map(|pair| i32::from(i16::from_le_bytes([pair[0], pair[1]]))).collect(),
            _ => bytes.iter().map(|&byte| i32::from(byte)).collect::<Vec<_>>(),
        };
        let near = steps(texel).iter().zip(steps(&expected)).all(|(found, expected)| found.abs_diff(expected) <= 1);
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
    let target = t.texture([5, 3], format);
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
    for format in [Format::Rgba8, Format::Bgra8Srgb, Format::Rgba16F, Format::Depth32F] {
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
            let target_depth = Some((target, Load::Clear(load)));
            t.list.raster(RasterPass { label: "suite.depth", colors: Vec::new(), depth: target_depth, draws });
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

pub(super) fn rows_come_back_tight_whatever_the_width(t: &mut Subject) {
    for (width, format) in [1, 3, 31, 63, 64, 65, 127, 130]
        .into_iter()
        .flat_map(|width| [(width, Format::Rgba8), (width, Format::Rgba16F)])
    {
        let target = t.texture([width, 5], format);
        let color = [1.0, 0.0, 1.0, 1.0];
        t.draw(target, Load::Clear(color), Vec::new());
        assert_eq!(t.texels(target), encode(format, color).repeat(width as usize * 5), "{width} {format:?}");
    }
}
