//! Pictures from the GPU, and their files.

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use glam::{Vec3, Vec4};
use half::f16;
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, Rgb32FImage, RgbImage, buffer::ConvertBuffer};

/// Colours in a read-back of four half floats each.
pub(crate) fn texels(bytes: &[u8]) -> impl Iterator<Item = Vec4> {
    let channel = |texel: &[u8], i: usize| f16::from_le_bytes([texel[2 * i], texel[2 * i + 1]]).to_f32();
    bytes.chunks_exact(8).map(move |texel| Vec4::from_array([0, 1, 2, 3].map(|i| channel(texel, i))))
}

/// Where pictures go: `--out`.
#[derive(Debug)]
pub(crate) enum Output {
    /// The last frame.
    Still(PathBuf),
    /// Every frame, `0000.png` and on.
    Folder(PathBuf),
    /// All frames in one file.
    Animation(PathBuf, Kind, Vec<RgbImage>),
}

/// A format of animations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Gif,
    Apng,
}

impl Output {
    /// Tells by the ending what is wanted, and makes sure that it can be written before anything is computed.
    pub(crate) fn new(path: &Path) -> Result<Self> {
        let text = path.to_string_lossy();
        if text.ends_with(['/', '\\']) || path.is_dir() {
            std::fs::create_dir_all(path).with_context(|| text.to_string())?;
            return Ok(Self::Folder(path.to_owned()));
        }
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let output = match ending.as_deref() {
            Some("png") => Self::Still(path.to_owned()),
            Some("gif") => Self::Animation(path.to_owned(), Kind::Gif, Vec::new()),
            Some("apng") => Self::Animation(path.to_owned(), Kind::Apng, Vec::new()),
            _ => bail!("{text}: the ending chooses the format: .png, .gif, .apng, or / for a folder"),
        };
        // A run that fails must neither cost the picture of an earlier one nor leave an empty one.
        let is_new = path.symlink_metadata().is_err();
        File::options().create(true).append(true).open(path).with_context(|| text.to_string())?;
        if is_new {
            std::fs::remove_file(path).with_context(|| text.to_string())?;
        }
        Ok(output)
    }

    /// Whether every frame is wanted, or only the last.
    pub(crate) fn wants_every_frame(&self) -> bool {
        !matches!(self, Self::Still(_))
    }

    /// Takes a frame that is wanted.
    pub(crate) fn push(&mut self, frame: u32, picture: RgbImage) -> Result<()> {
        let save = |path: &Path| picture.save(path).with_context(|| path.display().to_string());
        match self {
            Self::Still(path) => save(path),
            Self::Folder(folder) => save(&folder.join(format!("{frame:04}.png"))),
            Self::Animation(.., frames) => {
                frames.push(picture);
                Ok(())
            }
        }
    }

    /// Writes what has to be written in one piece.
    pub(crate) fn finish(self, fps: f64) -> Result<()> {
        let Self::Animation(path, kind, frames) = self else { return Ok(()) };
        let write = match kind {
            Kind::Gif => gif,
            Kind::Apng => apng,
        };
        write(&path, &frames, fps).with_context(|| path.display().to_string())
    }
}

/// Writes linear light, row by row, as it is: an OpenEXR picture.
pub(crate) fn write_linear(path: &Path, light: &[Vec3], size: [u32; 2]) -> Result<()> {
    let channels = light.iter().flat_map(|light| light.to_array()).collect();
    let picture = Rgb32FImage::from_raw(size[0], size[1], channels).expect("there is light for every pixel");
    picture.save(path).with_context(|| path.display().to_string())
}

fn create(path: &Path) -> Result<BufWriter<File>> {
    Ok(BufWriter::new(File::create(path).with_context(|| path.display().to_string())?))
}

/// GIF knows hundredths of a second, and players slow down anything faster than 50 frames a second: frames are left out.
fn gif(path: &Path, frames: &[RgbImage], fps: f64) -> Result<()> {
    let every = (fps / 50.0).ceil().max(1.0) as usize;
    let delay = Delay::from_numer_denom_ms((1000.0 * every as f64 / fps).round() as u32, 1);
    let mut encoder = GifEncoder::new_with_speed(create(path)?, 10);
    encoder.set_repeat(Repeat::Infinite)?;
    let frames = frames.iter().step_by(every).map(|frame| Frame::from_parts(frame.convert(), 0, 0, delay));
    Ok(encoder.encode_frames(frames)?)
}

fn apng(path: &Path, frames: &[RgbImage], fps: f64) -> Result<()> {
    let Some(first) = frames.first() else { return Ok(()) };
    let mut encoder = png::Encoder::new(create(path)?, first.width(), first.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(u32::try_from(frames.len())?, 0)?;
    let (numerator, denominator) = frame_delay(fps);
    encoder.set_frame_delay(numerator, denominator)?;
    let mut writer = encoder.write_header()?;
    for frame in frames {
        writer.write_image_data(frame)?;
    }
    Ok(writer.finish()?)
}

/// Seconds of a frame as the fraction of two 16-bit numbers that APNG asks for, as finely as they allow.
fn frame_delay(fps: f64) -> (u16, u16) {
    let scale = [1000.0, 100.0, 10.0, 1.0].into_iter().find(|scale| scale * fps <= 65_535.0).unwrap_or(1.0);
    (scale as u16, (scale * fps).round() as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_come_out_in_order() {
        let bytes: Vec<u8> = [1.0, 0.5, 0.25, 2.0].into_iter().flat_map(|v| f16::from_f32(v).to_le_bytes()).collect();
        assert_eq!(texels(&bytes).collect::<Vec<_>>(), [Vec4::new(1.0, 0.5, 0.25, 2.0)]);
    }

    #[test]
    fn a_frame_of_an_animation_lasts_as_long_as_it_should() {
        for fps in [1.0, 23.976, 60.0, 144.0, 10_000.0] {
            let (numerator, denominator) = frame_delay(fps);
            assert!((f64::from(denominator) / f64::from(numerator) - fps).abs() < 1e-3 * fps, "{fps}");
        }
    }

    #[test]
    fn an_unknown_ending_is_refused_before_anything_is_computed() {
        let error = Output::new(Path::new("picture.bmp")).unwrap_err();
        assert!(error.to_string().contains(".png"), "{error}");
    }
}
