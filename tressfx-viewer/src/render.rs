//! `tressfx render`.

use std::time::Instant;

use anyhow::Result;
use tressfx_asset::mesh::Mesh;

use crate::cli::Render;
use crate::passes;
use crate::picture::Output;
use crate::run::{Progress, Run};
use crate::studio::Studio;

/// Simulates all frames and draws those that are wanted.
pub(crate) fn run(args: &Render) -> Result<()> {
    let mut output = Output::new(&args.out)?;
    let mesh = args.mesh.as_ref().map(Mesh::read).transpose()?;
    let mut run = Run::new(&args.scene)?;
    let mut studio = Studio::new(&mut run, args, mesh)?;
    // Times of one frame say little: whoever asks for figures gets every frame drawn.
    let measured = args.scene.stats.is_some() || args.scene.profile || args.scene.trace.is_some();
    let draw_all = output.wants_every_frame() || measured;
    let progress = Progress::new(args.scene.frames);
    for frame in 0..args.scene.frames {
        let last = frame + 1 == args.scene.frames;
        let start = Instant::now();
        let mut list = run.step(&args.scene)?;
        let draw = draw_all || last;
        let drawn = draw.then(|| studio.draw(&mut list, run.head(&args.scene), run.sim.pose())).transpose()?;
        let wanted = output.wants_every_frame() || last;
        let picture = wanted.then(|| list.read_texture(studio.targets.color));
        if args.scene.print_passes && last {
            println!("{}", passes::table(&list));
        }
        run.trace.cpu("write the list", frame + 1, start);
        run.submit(&list)?;
        if let Some(counters) = drawn {
            let retake = studio.take_stock(&mut run, counters)?;
            if let Some(picture) = picture {
                let bytes = if retake { studio.retake(&mut run, &args.scene)? } else { run.fetch(picture)? };
                output.push(frame, crate::picture::developed(&bytes, args.size))?;
            }
        }
        progress.advance();
    }
    drop(progress);
    output.finish(args.scene.fps)?;
    run.report(&args.scene, studio.drawn)
}
