//! `tressfx simulate`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use glam::Vec4;
use tressfx_asset::WriteFormat;

use crate::cli::Simulate;
use crate::passes;
use crate::run::{Progress, Run};
use crate::say::say;
use crate::stats::RenderStats;

/// Simulates all frames and writes the pose that they end in.
pub(crate) fn run(args: &Simulate) -> Result<()> {
    let mut run = Run::new(&args.scene)?;
    let names: Vec<String> = run.groom.sections.iter().map(|section| section.name.clone()).collect();
    let files = files(&args.out, &names)?;
    let frames = Run::frames(&args.scene);
    let progress = Progress::new(frames.into(), "frame");
    for frame in 0..frames {
        let list = run.step(&args.scene)?;
        if args.scene.print_passes && frame == 0 {
            say(passes::table(&list))?;
        }
        run.submit(&list)?;
        progress.advance();
    }
    drop(progress);
    let (positions, pose) = (run.positions()?, run.sim.pose());
    let in_world = |position: &Vec4| pose.transform(position.truncate()).extend(position.w);
    for ((strands, positions), file) in run.groom.sections.iter().zip(&positions).zip(&files) {
        let positions: Vec<Vec4> = positions.iter().map(in_world).collect();
        tressfx_asset::write(file, &strands.pose_asset(&positions, args.all)?, Some(WriteFormat::TressFx4))?;
    }
    run.report(&args.scene, RenderStats::default())
}

/// One file a section.
fn files(out: &Path, names: &[String]) -> Result<Vec<PathBuf>> {
    let is_folder = out.to_string_lossy().ends_with(['/', '\\']) || out.is_dir();
    if !is_folder && names.len() > 1 {
        bail!("{}: {} grooms are written into a folder, whose name ends in /", out.display(), names.len());
    }
    if !is_folder {
        return Ok(vec![out.to_owned()]);
    }
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    let stem = |name: &String| {
        let name = name.replace([':', '/', '\\'], "_");
        Path::new(&name).file_stem().map_or(name.clone(), |stem| stem.to_string_lossy().into_owned())
    };
    Ok(names.iter().enumerate().map(|(index, name)| out.join(format!("{index}_{}.tfx", stem(name)))).collect())
}
