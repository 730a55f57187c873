//! Error against run time: techniques and their settings over scenes, each held against the reference renderer.
//!
//! It runs the program `tressfx`, links none of the other crates, and writes `accuracy.json`, `README.md` and a plot of each
//! scene. It is a program of its own, so that nobody who only wants to build and test waits for what draws plots.

mod change;
mod check;
mod figures;
mod measure;
mod method;
mod page;
mod plot;
mod program;
mod scene;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Parser, ValueEnum};

use crate::figures::{Extent, Report, Run};
use crate::measure::Measure;
use crate::program::Program;

/// Measure the error and the run time of the techniques
#[derive(Debug, Parser)]
#[command(name = "accuracy", version)]
struct Args {
    /// Write nothing: hold the errors against those of accuracy.json, and fail where one has grown by more than 10 %
    #[arg(long)]
    check: bool,
    /// Fewer scenes and settings, in small pictures
    #[arg(long)]
    quick: bool,
    /// Judge shadows in place of techniques, at rest and in motion, by light that is traced
    #[arg(long, conflicts_with = "quick")]
    light: bool,
    /// Measure this scene alone, and others that are named so; the rows of all others stay
    #[arg(long = "scene", value_name = "NAME", conflicts_with_all = ["check", "light", "pages"])]
    scenes: Vec<String>,
    /// What runs the passes
    #[arg(long, value_enum, default_value_t = Device::Wgpu)]
    device: Device,
    /// Measure nothing: write the page and the plots anew from accuracy.json
    #[arg(long, conflicts_with = "check")]
    pages: bool,
    /// Draw the pictures of the reference renderer anew: for when the look of the scenes has changed
    #[arg(long)]
    fresh: bool,
    /// The program `tressfx` that is measured
    #[arg(long, value_name = "FILE")]
    program: PathBuf,
    /// The folder with accuracy.json
    #[arg(long, value_name = "DIR")]
    docs: PathBuf,
    /// The folder for pictures and for what an interrupted run has measured
    #[arg(long, value_name = "DIR")]
    work: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Device {
    Wgpu,
    Vulkan,
    Both,
}

impl Device {
    /// As `tressfx --backend` takes them.
    fn backends(self) -> &'static [&'static str] {
        match self {
            Self::Wgpu => &["wgpu"],
            Self::Vulkan => &["vulkan"],
            Self::Both => &["wgpu", "vulkan"],
        }
    }
}

/// The plots of error against time; shadows have none, since their time is a part of the frame's.
fn plot(run: &Run, extent: Extent, docs: &Path) -> Result<()> {
    if extent == Extent::Light { Ok(()) } else { plot::write(run, docs) }
}

fn main() -> Result<()> {
    let args = Args::parse();
    let extent = match (args.quick, args.light) {
        (_, true) => Extent::Light,
        (true, _) => Extent::Quick,
        _ => Extent::Full,
    };
    let path = args.docs.join("accuracy.json");
    let mut report = Report::read(&path)?;
    let stored = report.run(extent).take();
    if args.check && stored.is_none() {
        bail!("{}: it holds no {} run to check against", path.display(), extent.name());
    }
    if args.pages {
        let run = stored.with_context(|| format!("{}: it holds no {} run", path.display(), extent.name()))?;
        plot(&run, extent, &args.docs)?;
        return page::write(&run, extent, &args.docs);
    }
    if let Some(stored) = stored.as_ref().filter(|_| args.check || !args.scenes.is_empty()) {
        // Said before all is measured.
        stored.check_setting(extent.setting())?;
    }
    let measure = Measure::new(Program::new(&args.program)?, &args.work, extent, args.fresh);
    let scenes = scene::named(scene::scenes(extent), &args.scenes)?;
    let rows = measure.all(&scenes, &method::methods(extent), args.device.backends())?;
    let mut run = Run { setting: extent.setting(), rows, changes: Vec::new(), note: None };
    match stored {
        Some(stored) if args.check => return check::check(&stored, &run),
        Some(stored) if !args.scenes.is_empty() => run = stored.with(run)?,
        _ => {}
    }
    if extent == Extent::Light {
        run.changes = change::changes(&Program::new(&args.program)?, &args.work)?;
    }
    std::fs::create_dir_all(&args.docs).with_context(|| args.docs.display().to_string())?;
    plot(&run, extent, &args.docs)?;
    page::write(&run, extent, &args.docs)?;
    *report.run(extent) = Some(run);
    report.write(&path)?;
    println!("The figures are in {}", args.docs.display());
    Ok(())
}
