//! Error against run time of the solvers: their sub-steps, rounds and vertices over strands with known answers and over grooms.
//!
//! It links the simulation, since it has to know where every tip is in every frame, and writes `motion.json`, `motion.md` and a
//! plot of each case.

mod case;
mod check;
mod drive;
mod figures;
mod known;
mod measure;
mod method;
mod page;
mod plate;
mod plot;
mod truth;

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::{Parser, ValueEnum};
use tressfx_backend_vulkan::VulkanBackend;
use tressfx_backend_wgpu::WgpuBackend;
use tressfx_core::backend::Run as Gpu;

use crate::figures::{Extent, Report, Run};
use crate::measure::Measure;

/// Measure the error and the run time of the solvers
#[derive(Debug, Parser)]
#[command(name = "motion", version)]
struct Args {
    /// Write nothing: hold the errors against those of motion.json, and fail where one has grown by more than 10 %
    #[arg(long)]
    check: bool,
    /// Fewer cases and settings, and fewer strands
    #[arg(long)]
    quick: bool,
    /// What runs the passes
    #[arg(long, value_enum, default_value_t = Device::Wgpu)]
    device: Device,
    /// Measure nothing: write the page and the plots anew from motion.json
    #[arg(long, conflicts_with = "check")]
    pages: bool,
    /// Measure nothing of this: make the plots of docs/motion.md, of the f64 function beside what thin rods are known to do
    #[arg(long, conflicts_with_all = ["check", "pages"])]
    known: bool,
    /// Measure nothing of this: make the plate of docs/materials.md, of stiffnesses of the published method beside bending lengths
    #[arg(long, conflicts_with_all = ["check", "pages", "known"])]
    plate: bool,
    /// The folder with motion.json
    #[arg(long, value_name = "DIR")]
    docs: PathBuf,
    /// The folder for what an interrupted run has measured
    #[arg(long, value_name = "DIR")]
    work: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Device {
    Wgpu,
    Vulkan,
}

impl Device {
    fn open(self) -> Result<Box<dyn Gpu>> {
        Ok(match self {
            Self::Wgpu => Box::new(WgpuBackend::headless()?),
            Self::Vulkan => Box::new(VulkanBackend::headless()?),
        })
    }
}

fn main() -> Result<()> {
    let args = Args::parse();
    if args.known {
        return known::write(&args.docs);
    }
    if args.plate {
        return plate::write(&args.docs);
    }
    let extent = if args.quick { Extent::Quick } else { Extent::Full };
    let path = args.docs.join("motion.json");
    let mut report = Report::read(&path)?;
    let stored = report.run(extent).take();
    if args.check && stored.is_none() {
        bail!("{}: it holds no {} run to check against", path.display(), extent.name());
    }
    if args.pages {
        let run = stored.with_context(|| format!("{}: it holds no {} run", path.display(), extent.name()))?;
        plot::write(&run, &args.docs)?;
        return page::write(&run, extent, &args.docs);
    }
    let rows = Measure::new(args.device, &args.work, extent)?.all()?;
    let run = Run { setting: extent.setting(), rows };
    if let Some(stored) = stored.filter(|_| args.check) {
        return check::check(&stored, &run);
    }
    std::fs::create_dir_all(&args.docs).with_context(|| args.docs.display().to_string())?;
    plot::write(&run, &args.docs)?;
    page::write(&run, extent, &args.docs)?;
    *report.run(extent) = Some(run);
    report.write(&path)?;
    println!("The figures are in {}", args.docs.display());
    Ok(())
}
