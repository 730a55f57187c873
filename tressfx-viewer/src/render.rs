//! `tressfx render`.

use std::time::Instant;

use anyhow::{Context, Result, bail};
use glam::{Vec3, Vec4};

use crate::cli::Render;
use crate::picture::{Output, texels, write_linear};
use crate::run::{Progress, Run};
use crate::say::say;
use crate::stats::RenderStats;
use crate::studio::Studio;
use crate::{hair_output, interpolate, passes, reference};

/// Simulates all frames and draws those that are wanted.
pub(crate) fn run(args: &Render) -> Result<()> {
    let mut output = Output::new(&args.out)?;
    if args.from >= Run::frames(&args.scene) {
        bail!("--from {}: frames are from 0 to {}", args.from, Run::frames(&args.scene) - 1);
    }
    let mut run = Run::new(&interpolate::scene(args))?;
    let mut studio = Studio::new(&mut run, args)?;
    let frames = Run::frames(&args.scene);
    let progress = Progress::new(frames.into(), "frame");
    for frame in 0..frames {
        self::frame(args, &mut run, &mut studio, &mut output, frame)?;
        progress.advance();
    }
    drop(progress);
    output.finish(args.scene.fps)?;
    hair_output::write(&mut run, &studio, args)?;
    run.report(&args.scene, studio.drawn)?;
    check_whole(args, &studio.drawn)
}

/// Says what is missing in the picture or out of order, and fails if that was asked for.
fn check_whole(args: &Render, drawn: &RenderStats) -> Result<()> {
    if args.reference {
        return Ok(());
    }
    let what = if drawn.technique == "tiles" { "references of tiles to segments" } else { "fragments" };
    let missing = format!("{} {what} found no room or were not come to: hair is missing in the picture", drawn.dropped);
    let merged = format!("{} fragments found no room and were merged: hair is there, its order is not", drawn.merged);
    let losses = [(drawn.dropped, missing), (drawn.merged, merged)];
    let said: Vec<_> = losses.into_iter().filter_map(|(count, said)| (count > 0).then_some(said)).collect();
    if args.strict && !said.is_empty() {
        bail!(said.join("; "));
    }
    said.iter().for_each(|said| eprintln!("{said}"));
    Ok(())
}

/// Simulates a frame, and draws it if it is wanted.
fn frame(args: &Render, run: &mut Run, studio: &mut Studio, output: &mut Output, frame: u32) -> Result<()> {
    let last = frame + 1 == Run::frames(&args.scene);
    let asked = last || (output.wants_every_frame() && frame >= args.from);
    let wanted = asked && !args.reference;
    // Times of one frame say little: whoever asks for figures gets every frame drawn.
    let measured = args.scene.stats.is_some() || args.scene.profile || args.scene.trace.is_some();
    let draw = wanted || (measured && !args.reference);
    let start = Instant::now();
    let mut list = run.step(&args.scene)?;
    if args.light_turn != 0.0 {
        studio.turn_lights((args.light_turn * frame as f32) % 360.0);
    }
    let drawn = draw.then(|| studio.draw(&mut list, run.head(&args.scene), run.sim.pose())).transpose()?;
    let picture = wanted.then(|| list.read_texture(studio.targets.color));
    if args.scene.print_passes && last {
        say(passes::table(&list))?;
    }
    // What the last frame is held against.
    if args.velocity_out.is_some() && frame + 2 == Run::frames(&args.scene) {
        studio.keep_past(&mut list, run.sim.pose())?;
    }
    run.trace.cpu("write the list", frame + 1, start);
    run.submit(&list)?;
    if let Some(counters) = drawn {
        let retake = studio.take_stock(run, counters)?;
        if let Some(picture) = picture {
            let bytes = if retake { studio.retake(run, &args.scene)? } else { run.fetch(picture)? };
            keep(args, output, frame, &texels(&bytes).map(Vec4::truncate).collect::<Vec<_>>())?;
        }
    }
    if asked && args.reference {
        keep(args, output, frame, &reference::picture(run, studio, args)?)?;
    }
    Ok(())
}

/// Takes the linear light of a frame that is wanted.
fn keep(args: &Render, output: &mut Output, frame: u32, light: &[Vec3]) -> Result<()> {
    let is_last = frame + 1 == Run::frames(&args.scene);
    if let Some(path) = args.linear_out.as_ref().filter(|_| is_last) {
        write_linear(path, light, args.size)?;
    }
    if let Some(path) = args.deep_out.as_ref().filter(|_| is_last) {
        args.develop.deep(light, args.size).save(path).with_context(|| path.display().to_string())?;
    }
    output.push(frame, args.develop.developed(light, args.size))
}
