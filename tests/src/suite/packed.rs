//! Colours as the bytes of texels.

use half::f16;
use tressfx_core::backend::Format;

/// A colour as the bytes of a texel.
pub(super) fn encode(format: Format, color: [f32; 4]) -> Vec<u8> {
    let [r, g, b, a] = color;
    let byte = |value: f32| unorm(value, 255.0) as u8;
    let srgb = |value: f32| byte(to_srgb(value));
    let halves = |values: &[f32]| values.iter().flat_map(|&value| f16::from_f32(value).to_le_bytes()).collect();
    match format {
        Format::Rgba8 => [r, g, b, a].map(byte).to_vec(),
        Format::Rgba8Srgb => vec![srgb(r), srgb(g), srgb(b), byte(a)],
        Format::Bgra8 => [b, g, r, a].map(byte).to_vec(),
        Format::Bgra8Srgb => vec![srgb(b), srgb(g), srgb(r), byte(a)],
        Format::Rgba16F => halves(&color),
        Format::Rg16F => halves(&[r, g]),
        Format::R16F => halves(&[r]),
        Format::Rgb10A2 => {
            let [r, g, b] = [r, g, b].map(|value| unorm(value, 1023.0));
            (r | g << 10 | b << 20 | unorm(a, 3.0) << 30).to_le_bytes().to_vec()
        }
        Format::R11G11B10F => (unsigned(r, 6) | unsigned(g, 6) << 11 | unsigned(b, 5) << 22).to_le_bytes().to_vec(),
        Format::Rg32F => [r, g].map(f32::to_le_bytes).concat(),
        Format::R32F | Format::Depth32F => r.to_le_bytes().to_vec(),
        Format::R32Uint => (r as u32).to_le_bytes().to_vec(),
        other => panic!("the suite does not know {other:?} yet"),
    }
}

/// The channels of a texel as numbers, of which neighbours are one rounding apart.
pub(super) fn steps(format: Format, texel: &[u8]) -> Vec<i64> {
    let words = || texel.chunks(4).map(|word| i64::from(u32::from_le_bytes([word[0], word[1], word[2], word[3]])));
    let word = || words().next().expect("a texel of at least four bytes");
    let fields = |ends: &[u32]| ends.windows(2).map(|pair| (word() >> pair[0]) % (1 << (pair[1] - pair[0]))).collect();
    match format {
        Format::Rgba16F | Format::Rg16F | Format::R16F => {
            texel.chunks(2).map(|pair| i64::from(i16::from_le_bytes([pair[0], pair[1]]))).collect()
        }
        Format::Rgb10A2 => fields(&[0, 10, 20, 30, 32]),
        Format::R11G11B10F => fields(&[0, 11, 22, 32]),
        Format::Rg32F | Format::R32F | Format::R32Uint | Format::Depth32F => words().collect(),
        _ => texel.iter().map(|&byte| i64::from(byte)).collect(),
    }
}

fn unorm(value: f32, most: f32) -> u32 {
    (value.clamp(0.0, 1.0) * most).round() as u32
}

fn to_srgb(value: f32) -> f32 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

/// A float without a sign, of five bits of exponent and some of mantissa: the upper bits of a half, rounded.
fn unsigned(value: f32, mantissa: u32) -> u32 {
    let dropped = 10 - mantissa;
    (u32::from(f16::from_f32(value.max(0.0)).to_bits()) + (1 << (dropped - 1))) >> dropped
}
