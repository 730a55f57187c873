//! Error against run time: techniques and their settings over scenes, each held against the reference renderer.
//!
//! It runs the program `tressfx`, links none of the other crates, and writes `accuracy.json`, `README.md` and a plot of each
//! scene. It is a program of its own, so that nobody who only wants to build and test waits for what draws plots.

mod change;
mod check;
mod figures;
mod growth;
mod growth_plot;
mod measure;
mod method;
mod page;
mod plot;
mod program;
mod scene;
mod times;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Parser, ValueEnum};

use crate::figures::{Extent, Report, Run};
use crate::growth::Growth;
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
    /// Measure how time grows with the number of strands, in place of errors; with --pages only write its page and plot anew
    #[arg(long, conflicts_with_all = ["check", "quick", "light", "scenes", "times", "fresh"])]
    growth: bool,
    /// Judge shadows in place of techniques, at rest and in motion, by light that is traced
    #[arg(long, conflicts_with = "quick")]
    light: bool,
    /// Measure this scene alone, and others that are named so; the rows of all others stay
    #[arg(long = "scene", value_name = "NAME", conflicts_with_all = ["check", "light", "pages"])]
    scenes: Vec<String>,
    /// Take run times alone anew: for when a change has left the pictures as they were. Errors stay
    #[arg(long, conflicts_with_all = ["check", "light", "pages", "fresh"])]
    times: bool,
    /// Of this method alone, and of others that are named so; the rows of all others stay
    #[arg(long = "method", value_name = "NAME", conflicts_with_all = ["check", "light", "pages"])]
    methods: Vec<String>,
    /// What runs the passes; with --times what ran them before
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
    if args.growth {
        return grow(&args);
    }
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
    if let Some(stored) =
        stored.as_ref().filter(|_| args.check || args.times || !args.scenes.is_empty() || !args.methods.is_empty())
    {
        // Said before all is measured.
        stored.check_setting(extent.setting())?;
    }
    let measure = Measure::new(Program::new(&args.program)?, &args.work, extent, args.fresh);
    let scenes = scene::named(scene::scenes(extent), &args.scenes)?;
    let methods = method::named(method::methods(extent), &args.methods)?;
    if args.times {
        let run = stored.with_context(|| format!("{}: it holds no {} run", path.display(), extent.name()))?;
        return write(report, times::anew(&measure, run, &scenes, &methods)?, extent, &args.docs);
    }
    let rows = measure.all(&scenes, &methods, args.device.backends())?;
    let mut run = Run { setting: extent.setting(), rows, changes: Vec::new(), note: None };
    match stored {
        Some(stored) if args.check => return check::check(&stored, &run),
        Some(stored) if !args.methods.is_empty() => run = stored.with_methods(run)?,
        Some(stored) if !args.scenes.is_empty() => run = stored.with(run)?,
        _ => {}
    }
    if extent == Extent::Light {
        run.changes = change::changes(&Program::new(&args.program)?, &args.work)?;
    }
    write(report, run, extent, &args.docs)
}

/// How time grows with the number of strands; of both backends, on the first.
fn grow(args: &Args) -> Result<()> {
    let growth = match args.pages {
        true => Growth::read(&args.docs.join("growth.json"))?,
        false => growth::measure(&Program::new(&args.program)?, args.device.backends()[0], &args.work)?,
    };
    std::fs::create_dir_all(&args.docs).with_context(|| args.docs.display().to_string())?;
    growth::write(&growth, &args.docs)?;
    println!("The figures are in {}", args.docs.display());
    Ok(())
}

/// Plots, the page and the file.
fn write(mut report: Report, run: Run, extent: Extent, docs: &Path) -> Result<()> {
    std::fs::create_dir_all(docs).with_context(|| docs.display().to_string())?;
    plot(&run, extent, docs)?;
    page::write(&run, extent, docs)?;
    *report.run(extent) = Some(run);
    report.write(&docs.join("accuracy.json"))?;
    println!("The figures are in {}", docs.display());
    Ok(())
}
