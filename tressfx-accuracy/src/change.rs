//! Whether shadows stand still: how much the picture changes from frame to frame, beside how much that of the reference renderer does.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use crate::program::Program;

/// Frames of a film.
const FRAMES: u32 = 120;

/// Few strands in small pictures: the reference renderer draws each frame.
const GROOM: &str = "builtin:curly:1000:32";
const SIZE: &str = "160x90";

/// Rays a pixel of the reference renderer, and a quarter of them, which tells how much of the change is its noise.
const SAMPLES: [u32; 2] = [64, 16];

/// What moves.
const FILMS: [(&str, [&str; 2]); 2] = [("head turns", ["--motion", "turn"]), ("lights walk", ["--light-turn", "3"])];

/// How much a film changes: mean FLIP from a frame to the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Change {
    pub(crate) film: String,
    pub(crate) groom: String,
    pub(crate) size: String,
    pub(crate) frames: u32,
    pub(crate) shadows: f64,
    pub(crate) reference: f64,
    /// The reference renderer's with a quarter of the rays.
    pub(crate) noisier: f64,
    /// The largest change of a step over that of the reference renderer in it.
    pub(crate) largest: f64,
}

/// All films; `folder` keeps their frames.
pub(crate) fn changes(program: &Program, folder: &Path) -> Result<Vec<Change>> {
    FILMS.iter().map(|(film, words)| of_film(program, folder, film, words)).collect()
}

fn of_film(program: &Program, folder: &Path, film: &str, words: &[&str]) -> Result<Change> {
    let folder = folder.join("films").join(film.replace(' ', "-"));
    let frames = FRAMES.to_string();
    let common = [&[GROOM, "--size", SIZE, "--frames", &frames], words].concat();
    let steps = |name: &str, stamp: &str, own: &[&str]| -> Result<Vec<f64>> {
        let folder = folder.join(name);
        draw(program, &folder, stamp, &[&common, own].concat())?;
        let frame = |index: u32| folder.join(format!("{index:04}.png"));
        (1..FRAMES).map(|index| Ok(program.compare(&frame(index - 1), &frame(index))?.flip_mean)).collect()
    };
    let traced = |samples: u32| {
        let count = samples.to_string();
        steps(&format!("reference-{samples}"), "", &["--reference", "--samples", &count])
    };
    let [reference, noisier] = [traced(SAMPLES[0])?, traced(SAMPLES[1])?];
    let shadows = steps("shadows", &program.stamp, &["--oit", "tiles", "--places", "4"])?;
    let mean = |all: &[f64]| all.iter().sum::<f64>() / all.len() as f64;
    Ok(Change {
        film: film.to_owned(),
        groom: GROOM.to_owned(),
        size: SIZE.to_owned(),
        frames: FRAMES,
        shadows: mean(&shadows),
        reference: mean(&reference),
        noisier: mean(&noisier),
        largest: shadows.iter().zip(&reference).map(|(a, b)| a / b).fold(0.0, f64::max),
    })
}

/// Draws all frames, unless they are there and were drawn with the same words by the program of that stamp.
fn draw(program: &Program, folder: &PathBuf, stamp: &str, words: &[&str]) -> Result<()> {
    let (drawn_with, typed) = (folder.join("words.txt"), format!("{} {stamp}", words.join(" ")));
    if fs::read_to_string(&drawn_with).is_ok_and(|text| text == typed) {
        return Ok(());
    }
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
    // A name that ends in a slash is a folder for every frame.
    program.render(&words, &folder.join(""))?;
    fs::write(&drawn_with, typed).with_context(|| drawn_with.display().to_string())
}

/// The part of the page.
pub(crate) fn page(changes: &[Change]) -> String {
    let Some(Change { groom, size, frames, .. }) = changes.first() else { return String::new() };
    let rows = changes.iter().map(|change| {
        let Change { film, shadows, reference, noisier, largest, .. } = change;
        let more = 100.0 * (shadows / reference - 1.0);
        format!("| {film} | {shadows:.5} | {reference:.5} | {noisier:.5} | {more:+.1} % | {largest:.2} |\n")
    });
    format!(
        "\n## From frame to frame\n\n\
         Shadows that flicker or swim change a picture more than what moves in it. {frames} frames of `{groom}` at {size}, of 8 bits a channel: mean FLIP from a frame to \
         the next, of the method `shadows-192` and of the reference renderer with {} samples a pixel. With {} samples it has twice the noise: what that adds \
         is more than what noise there is in the figure before. The last column is the change of one step over that of the reference renderer, at most.\n\n\
         | film | shadows-192 | reference | with a quarter of the samples | shadows-192 beside the reference | largest |\n|---|---|---|---|---|---|\n{}",
        SAMPLES[0],
        SAMPLES[1],
        rows.collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_says_how_much_more_a_film_changes() {
        let change = Change {
            film: "head turns".into(),
            groom: GROOM.into(),
            size: SIZE.into(),
            frames: FRAMES,
            shadows: 0.022,
            reference: 0.02,
            noisier: 0.021,
            largest: 1.25,
        };
        let text = page(&[change]);
        assert!(text.contains("| head turns | 0.02200 | 0.02000 | 0.02100 | +10.0 % | 1.25 |"), "{text}");
        assert_eq!(page(&[]), "");
    }
}
