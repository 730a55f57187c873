//! From linear light to a picture for a screen: `--exposure` and `--tone-map`.

use clap::{Args, ValueEnum};
use glam::{Mat3, Vec3};
use image::{ImageBuffer, Pixel, Primitive, Rgb, RgbImage};

/// How light becomes a picture.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Develop {
    /// Stops by which the picture is brighter: each doubles the light
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = stops, allow_negative_numbers = true)]
    exposure: f32,
    /// How light that a screen cannot show is brought down
    #[arg(long, value_enum, default_value_t = ToneMap::Knee)]
    tone_map: ToneMap,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ToneMap {
    /// What is above 0.8 rolls off towards white; all below stays as it is
    Knee,
    /// The film curve of the Academy Color Encoding System, as Narkowicz (2015) fitted it
    Aces,
    /// AgX of Sobotka, as Wrensch (2023) fitted it: bright colours lose their saturation as on film
    Agx,
}

fn stops(text: &str) -> Result<f32, String> {
    let stops: f32 = text.parse().map_err(|_| "not a number of stops")?;
    if (-20.0..=20.0).contains(&stops) { Ok(stops) } else { Err("must be from -20 to 20 stops".to_owned()) }
}

impl Develop {
    /// Turns linear light, row by row, into a picture in sRGB.
    pub(crate) fn developed(&self, light: &[Vec3], size: [u32; 2]) -> RgbImage {
        self.picture(light, size, |level| (level * 255.0 + 0.5) as u8)
    }

    /// The same with 16 bits a channel.
    pub(crate) fn deep(&self, light: &[Vec3], size: [u32; 2]) -> ImageBuffer<Rgb<u16>, Vec<u16>> {
        self.picture(light, size, |level| (level * 65535.0 + 0.5) as u16)
    }

    /// A picture of what is made of levels from 0 to 1 in sRGB.
    fn picture<C: Primitive>(
        &self,
        light: &[Vec3],
        size: [u32; 2],
        of: impl Fn(f32) -> C,
    ) -> ImageBuffer<Rgb<C>, Vec<C>>
    where
        Rgb<C>: Pixel<Subpixel = C>,
    {
        let (mut light, scale) = (light.iter(), self.exposure.exp2());
        ImageBuffer::from_fn(size[0], size[1], |_, _| {
            let light = light.next().expect("there is light for every pixel");
            // The comparison is false for what is no number.
            let scaled =
                light.to_array().map(|channel| if channel > 0.0 { (scale * channel).min(f32::MAX) } else { 0.0 });
            Rgb(self.tone_map.encoded(Vec3::from_array(scaled)).to_array().map(&of))
        })
    }
}

impl ToneMap {
    /// Levels from 0 to 1 in sRGB for linear light that is not negative.
    fn encoded(self, light: Vec3) -> Vec3 {
        match self {
            Self::Knee => per_channel(light, |channel| encode(knee(channel))),
            Self::Aces => per_channel(light, |channel| encode(aces(channel))),
            Self::Agx => agx(light),
        }
    }
}

fn per_channel(light: Vec3, curve: impl Fn(f32) -> f32) -> Vec3 {
    Vec3::from_array(light.to_array().map(curve))
}

/// The sRGB transfer function (IEC 61966-2-1).
fn encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Highlights keep their shape.
fn knee(light: f32) -> f32 {
    const KNEE: f32 = 0.8;
    if light > KNEE { KNEE + (1.0 - KNEE) * (1.0 - (-(light - KNEE) / (1.0 - KNEE)).exp()) } else { light }
}

/// Narkowicz, "ACES Filmic Tone Mapping Curve", 2015.
fn aces(light: f32) -> f32 {
    // Beyond, the quotient of two squares would be infinite; the curve is flat.
    let x = light.min(1e6);
    ((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0)
}

/// Wrensch, "Minimal AgX Implementation", 2023: 16.5 stops around middle gray, in a space in which no channel can be alone.
fn agx(light: Vec3) -> Vec3 {
    const STOPS: [f32; 2] = [-12.473_93, 4.026_069];
    const INTO: Mat3 = Mat3::from_cols(
        Vec3::new(0.842_479_06, 0.042_328_242, 0.042_375_655),
        Vec3::new(0.078_433_6, 0.878_468_64, 0.078_433_6),
        Vec3::new(0.079_223_745, 0.079_166_13, 0.879_143),
    );
    let stops = |channel: f32| (channel.max(1e-10).log2() - STOPS[0]) / (STOPS[1] - STOPS[0]);
    let level = |channel: f32| contrast(stops(channel).clamp(0.0, 1.0));
    // What comes out is encoded by a power of 2.2; levels here are those of sRGB.
    let linear =
        per_channel(INTO.inverse() * per_channel(INTO * light, level), |level| level.clamp(0.0, 1.0).powf(2.2));
    per_channel(linear, encode)
}

/// The curve of AgX as a polynomial.
fn contrast(x: f32) -> f32 {
    const TERMS: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.002_32];
    TERMS.into_iter().fold(0.0, |sum, term| sum * x + term)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [ToneMap; 3] = [ToneMap::Knee, ToneMap::Aces, ToneMap::Agx];

    fn level(tone_map: ToneMap, exposure: f32, light: f32) -> u8 {
        let develop = Develop { exposure, tone_map };
        let (light, size) = ([Vec3::splat(light)], [1, 1]);
        let (level, deep) = (develop.developed(&light, size)[(0, 0)][0], develop.deep(&light, size)[(0, 0)][0]);
        assert!((f32::from(deep) / 257.0 - f32::from(level)).abs() <= 0.502, "{level} and {deep}");
        level
    }

    #[test]
    fn curves_keep_their_ends_and_their_order() {
        for tone_map in ALL {
            for dark in [0.0, -1.0, f32::NAN] {
                assert_eq!(level(tone_map, 0.0, dark), 0, "{tone_map:?}");
            }
            for bright in [1e6, f32::MAX, f32::INFINITY] {
                assert!(level(tone_map, 20.0, bright) >= 253, "{tone_map:?}: {}", level(tone_map, 20.0, bright));
            }
            let steps: Vec<u8> = (0..1000).map(|i| level(tone_map, 0.0, i as f32 * 0.004)).collect();
            assert!(steps.is_sorted(), "{tone_map:?}");
        }
        assert_eq!(level(ToneMap::Knee, 0.0, 0.5), 188, "sRGB of half the light");
    }

    /// Of ACES, 0.18 comes to 0.267 and 1 to 0.804; of AgX, middle gray is in the middle of all levels.
    #[test]
    fn curves_are_those_that_were_published() {
        assert!((aces(0.18) - 0.2669).abs() < 1e-3, "{}", aces(0.18));
        assert!((aces(1.0) - 0.8038).abs() < 1e-3, "{}", aces(1.0));
        let gray = i32::from(level(ToneMap::Agx, 0.0, 0.18));
        assert!((gray - 128).abs() < 3, "{gray}");
        let red = ToneMap::Agx.encoded(Vec3::X * 100.0);
        assert!(red.y > 0.5 && red.x > red.y, "bright red goes to white: {red}");
    }

    #[test]
    fn a_stop_doubles_the_light() {
        assert_eq!(level(ToneMap::Knee, 1.0, 0.2), level(ToneMap::Knee, 0.0, 0.4));
        assert_eq!(level(ToneMap::Knee, -2.0, 0.4), level(ToneMap::Knee, 0.0, 0.1));
    }

    #[test]
    fn rows_come_out_in_order() {
        let develop = Develop { exposure: 0.0, tone_map: ToneMap::Knee };
        let picture = develop.developed(&[Vec3::X, Vec3::Y], [1, 2]);
        assert!(picture[(0, 0)][0] > 230 && picture[(0, 0)][1] == 0);
        assert!(picture[(0, 1)][1] > 230 && picture[(0, 1)][0] == 0);
    }
}
