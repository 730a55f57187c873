//! Depth and coverage of the hair as pictures of 16-bit gray, and its motion in colours: `--depth-out`, `--coverage-out` and `--velocity-out`.

use std::path::Path;

use anyhow::{Context, Result, bail};
use image::{ImageBuffer, Luma, PixelWithColorType, Rgb};
use tressfx_core::pass::PassList;
use tressfx_core::view::Lens;

use crate::cli::Render;
use crate::run::Run;
use crate::say::say;
use crate::studio::{NO_MOTION, Studio};

/// Gray of the farthest hair. What has no hair is black.
const FARTHEST: f32 = 4096.0;

/// White: the nearest hair, and hair that covers all of a pixel.
const WHITE: f32 = 65_535.0;

/// Writes the pictures that were asked for, of the frame that was drawn last.
pub(crate) fn write(run: &mut Run, studio: &Studio, args: &Render) -> Result<()> {
    write_velocity(run, studio, args)?;
    let Some(hair) = studio.targets.hair else { return Ok(()) };
    let mut list = PassList::new();
    let ticket = list.read_texture(hair);
    run.submit(&list)?;
    let pixels: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(&run.fetch(ticket)?);
    if let Some(path) = &args.coverage_out {
        let gray = pixels.iter().map(|[_, coverage]| (coverage * WHITE).round() as u16);
        save::<Luma<u16>>(path, args.size, gray.collect())?;
    }
    if let Some(path) = &args.depth_out {
        let distances: Vec<_> = pixels.iter().map(|pixel| distance(studio.view.lens(), *pixel)).collect();
        let (gray, said) = grays(&distances);
        say(format_args!("{}: {said}", path.display()))?;
        save::<Luma<u16>>(path, args.size, gray)?;
    }
    Ok(())
}

/// How far from the eye the hair of a pixel is, if it has any.
fn distance(lens: &Lens, [depth, coverage]: [f32; 2]) -> Option<f32> {
    let nearness = (depth - lens.depth_offset) * lens.depth_scale;
    let distance = if lens.is_perspective { 1.0 / nearness } else { (1.0 - nearness) / lens.nearness_slope };
    (coverage > 0.0).then_some(distance)
}

/// Gray that falls evenly with the distance, and what it stands for, in words.
fn grays(distances: &[Option<f32>]) -> (Vec<u16>, String) {
    let found = || distances.iter().flatten().copied();
    let (near, far) = (found().fold(f32::INFINITY, f32::min), found().fold(0.0, f32::max));
    let gray = |distance: f32| {
        let part = (distance - near) / (far - near).max(f32::MIN_POSITIVE);
        (WHITE + (FARTHEST - WHITE) * part).round() as u16
    };
    let grays = distances.iter().map(|distance| distance.map_or(0, gray)).collect();
    let said = if near > far {
        "no pixel has hair: all are 0".to_owned()
    } else {
        format!(
            "distance from the eye in the unit of the groom, {near:.4} is 65535, {far:.4} is {FARTHEST}; no hair is 0"
        )
    };
    (grays, said)
}

/// Writes the motion of the hair, if it was asked for.
fn write_velocity(run: &mut Run, studio: &Studio, args: &Render) -> Result<()> {
    let (Some(velocity), Some(path)) = (studio.targets.velocity, &args.velocity_out) else { return Ok(()) };
    let mut list = PassList::new();
    let ticket = list.read_texture(velocity);
    run.submit(&list)?;
    let motions: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(&run.fetch(ticket)?);
    let (colors, said) = colors(&motions);
    say(format_args!("{}: {said}", path.display()))?;
    save::<Rgb<u16>>(path, args.size, colors)
}

/// No motion.
const STILL: f32 = 32_768.0;

/// Red for motion to the right and green for motion down, around a middle gray, and what it stands for, in words.
fn colors(motions: &[[f32; 2]]) -> (Vec<u16>, String) {
    let has_hair = |motion: &&[f32; 2]| **motion != [NO_MOTION; 2];
    let largest = motions.iter().filter(has_hair).flatten().fold(0.0f32, |largest, part| largest.max(part.abs()));
    let level = |part: f32| (STILL + (WHITE - STILL) * part / largest.max(f32::MIN_POSITIVE)).round() as u16;
    let color = |motion: &[f32; 2]| match has_hair(&motion) {
        true => [level(motion[0]), level(motion[1]), STILL as u16],
        false => [0; 3],
    };
    let said = format!(
        "motion since the frame before, red to the right and green down: 65535 is {largest:.4} pixels, 32768 none; no hair is black"
    );
    (motions.iter().flat_map(color).collect(), said)
}

fn save<P>(path: &Path, size: [u32; 2], levels: Vec<u16>) -> Result<()>
where
    P: PixelWithColorType<Subpixel = u16>,
{
    let Some(picture) = ImageBuffer::<P, _>::from_raw(size[0], size[1], levels) else {
        bail!("{}: the texture that came back is smaller than the picture", path.display())
    };
    picture.save(path).with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_is_as_far_from_gray_as_it_is_long() {
        let (colors, said) = colors(&[[2.0, -1.0], [NO_MOTION; 2], [0.0, 0.0]]);
        assert_eq!(colors, [65_535, 16_385, 32_768, 0, 0, 0, 32_768, 32_768, 32_768]);
        assert!(said.contains("65535 is 2.0000 pixels"), "{said}");
        assert_eq!(self::colors(&[[0.0; 2]]).0, [32_768; 3], "hair at rest");
    }

    #[test]
    fn gray_falls_from_the_nearest_to_the_farthest() {
        let (gray, said) = grays(&[Some(2.0), None, Some(4.0), Some(3.0)]);
        assert_eq!(gray, [65_535, 0, 4096, 34_816]);
        assert!(said.contains("2.0000 is 65535, 4.0000 is 4096"), "{said}");
        assert_eq!(grays(&[Some(1.0)]).0, [65_535], "hair at one distance");
        assert!(grays(&[None]).1.contains("no pixel"));
    }
}
