//! Random and hostile cases for the solvers, for as long as one likes.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Parser, ValueEnum};
use tressfx_stress::case::{Case, Part, SolverName};
use tressfx_stress::gpu::{BackendName, Gpu};
use tressfx_stress::judge::judge;
use tressfx_stress::run::{Run, Settings, State};
use tressfx_stress::{page, plot};

/// Random and hostile cases for the solvers; a run that was stopped goes on
#[derive(Debug, Parser)]
#[command(name = "stress", version)]
struct Args {
    /// How long it runs, with the time that it ran before it was stopped
    #[arg(long, default_value_t = 1.0)]
    hours: f64,
    /// All cases follow from it
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// What runs the passes; with both, a share of the cases is played on both and has to agree to the bit
    #[arg(long, value_enum, default_value_t = Backends::Both)]
    backend: Backends,
    /// What moves the strands
    #[arg(long, value_enum, default_value_t = Solvers::Both)]
    solver: Solvers,
    /// Play the case of this seed alone, and say what is wrong with it
    #[arg(long, value_name = "SEED")]
    case: Option<u64>,
    /// Draw no map of stability
    #[arg(long)]
    no_map: bool,
    /// Try nothing: write the page and the maps anew from what a run has counted
    #[arg(long, requires = "docs")]
    pages: bool,
    /// Begin anew
    #[arg(long)]
    fresh: bool,
    /// The folder for stress.md, stress.json and the maps; none is written if it is left out
    #[arg(long, value_name = "DIR")]
    docs: Option<PathBuf>,
    /// The folder for how far the run has come
    #[arg(long, value_name = "DIR", default_value = "out/stress")]
    work: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Backends {
    Wgpu,
    Vulkan,
    Both,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Solvers {
    Direct,
    Tressfx,
    Both,
}

impl Args {
    fn settings(&self) -> Settings {
        let backends = match self.backend {
            Backends::Wgpu => vec![BackendName::Wgpu],
            Backends::Vulkan => vec![BackendName::Vulkan],
            Backends::Both => vec![BackendName::Wgpu, BackendName::Vulkan],
        };
        let solvers = match self.solver {
            Solvers::Direct => vec![SolverName::Direct],
            Solvers::Tressfx => vec![SolverName::Tressfx],
            Solvers::Both => vec![SolverName::Direct, SolverName::Tressfx],
        };
        Settings { seed: self.seed, solvers, backends }
    }
}

fn main() -> Result<()> {
    let args = Args::parse();
    if let Some(seed) = args.case {
        return play(seed, &args.settings());
    }
    for folder in [Some(&args.work), args.docs.as_ref()].into_iter().flatten() {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let path = args.work.join("run.json");
    if args.pages {
        let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        return report(&serde_json::from_str(&text)?, args.docs.as_deref());
    }
    let state = match args.fresh {
        true => {
            State { program: State::resume(Path::new(""), args.settings())?.program, ..State::new(args.settings()) }
        }
        false => State::resume(&path, args.settings())?,
    };
    let mut run = Run::new(state, Some(path))?;
    if !args.no_map {
        run.map()?;
    }
    run.for_seconds(args.hours * 3600.0)?;
    report(&run.state, args.docs.as_deref())
}

/// Plays one case on each backend, with each solver.
fn play(seed: u64, settings: &Settings) -> Result<()> {
    let mut failed = 0;
    for &name in &settings.backends {
        let mut gpu = Gpu::open(name)?;
        for &solver in &settings.solvers {
            println!("{}", Case::new(seed, solver, Part::ALL)?);
            let verdict = judge(&mut gpu, seed, solver, Part::ALL)?;
            println!("seed {seed}, {}, {}: {verdict:?}", solver.name(), name.name());
            failed += verdict.troubles.len();
        }
    }
    if failed > 0 { bail!("{failed} troubles") } else { Ok(()) }
}

fn report(state: &State, docs: Option<&Path>) -> Result<()> {
    if let Some(docs) = docs {
        let write = |name: &str, text: &str| {
            let path = docs.join(name);
            std::fs::write(&path, text).with_context(|| path.display().to_string())
        };
        write("stress.md", &page::page(state))?;
        write("stress.json", &(serde_json::to_string_pretty(state)? + "\n"))?;
        for solver in &state.settings.solvers {
            if state.map.iter().any(|cell| cell.solver == *solver) {
                write(&format!("stress-{}.svg", solver.name()), &plot::map(*solver, &state.map)?)?;
            }
        }
    }
    for (solver, tally) in &state.tallies {
        let (cases, failed, sub_steps) = (tally.cases, tally.failed, tally.sub_steps);
        println!("{}: {cases} cases, {sub_steps} sub-steps, {failed} cases failed", solver.name());
    }
    let failed: u64 = state.tallies.values().map(|tally| tally.failed).sum();
    if failed > 0 { bail!("{failed} cases failed") } else { Ok(()) }
}
