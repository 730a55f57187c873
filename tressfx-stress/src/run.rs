//! A run over many cases, which goes on where it was stopped.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, UNIX_EPOCH};

use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};

use crate::case::{Part, SolverName};
use crate::dice::Dice;
use crate::gpu::{BackendName, Gpu};
use crate::judge::judge;
use crate::kept::minimised;
use crate::map::{Cell, VERTICES, column};
use crate::tally::Tally;
use crate::verdict::{Failure, Trouble, Verdict};

/// Of so many cases one is played on both backends.
const COMPARED: u64 = 4;
/// See [`Run::made_smaller`].
const MADE_SMALLER: usize = 4;

/// What is tried.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Settings {
    /// All cases follow from it.
    pub seed: u64,
    /// Solvers, in turns.
    pub solvers: Vec<SolverName>,
    /// Backends, in turns.
    pub backends: Vec<BackendName>,
}

/// How far a run has come.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct State {
    /// What is tried.
    pub settings: Settings,
    /// The program that was run: another one begins anew.
    pub program: String,
    /// The devices, in words.
    pub devices: Vec<String>,
    /// The index of the next case.
    pub next: u64,
    /// How long it has run, s.
    pub seconds: f64,
    /// What was counted, for each solver.
    pub tallies: BTreeMap<SolverName, Tally>,
    /// What failed.
    pub failures: Vec<Failure>,
    /// Cells of the map of stability so far.
    pub map: Vec<Cell>,
}

impl State {
    /// Nothing was tried yet.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            program: String::new(),
            devices: Vec::new(),
            next: 0,
            seconds: 0.0,
            tallies: BTreeMap::new(),
            failures: Vec::new(),
            map: Vec::new(),
        }
    }

    /// Goes on from a file, if it is of the same settings and program.
    ///
    /// # Errors
    /// The program does not find itself.
    pub fn resume(path: &Path, settings: Settings) -> Result<Self> {
        let program = program()?;
        let earlier = fs::read_to_string(path).ok().and_then(|text| serde_json::from_str::<Self>(&text).ok());
        let earlier = earlier.filter(|state| state.settings == settings && state.program == program);
        Ok(earlier.unwrap_or_else(|| Self { program, ..Self::new(settings) }))
    }

    /// Writes it under another name first: what has its name is whole.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let part = path.with_extension("part");
        fs::write(&part, serde_json::to_string_pretty(self)? + "\n").with_context(|| part.display().to_string())?;
        fs::rename(&part, path).with_context(|| path.display().to_string())
    }
}

/// Changes when the program is built anew.
fn program() -> Result<String> {
    let about = fs::metadata(std::env::current_exe()?)?;
    let changed = about.modified()?.duration_since(UNIX_EPOCH)?.as_nanos();
    Ok(format!("{} bytes, {changed}", about.len()))
}

/// A run and the devices that it has.
pub struct Run {
    /// How far it has come.
    pub state: State,
    gpus: Vec<Gpu>,
    path: Option<PathBuf>,
    /// Failures of one kind that are made smaller; that takes longer than to find them.
    made_smaller: usize,
}

impl Run {
    /// Opens the devices. Where there is a `path`, how far it has come is written there.
    ///
    /// # Errors
    /// There is no device.
    pub fn new(mut state: State, path: Option<PathBuf>) -> Result<Self> {
        let gpus = state.settings.backends.iter().map(|&name| Gpu::open(name)).collect::<Result<Vec<_>>>()?;
        state.devices = gpus.iter().map(|gpu| format!("{} ({})", gpu.name.name(), gpu.device())).collect();
        Ok(Self { state, gpus, path, made_smaller: MADE_SMALLER })
    }

    /// The same, but what fails is kept as it is.
    #[must_use]
    pub fn as_they_are(self) -> Self {
        Self { made_smaller: 0, ..self }
    }

    /// Draws what is missing of the map.
    ///
    /// # Errors
    /// What the simulation or a backend says.
    pub fn map(&mut self) -> Result<()> {
        let columns =
            self.state.settings.solvers.iter().flat_map(|&solver| VERTICES.map(|vertices| (solver, vertices)));
        let is_there = |(solver, vertices): &(SolverName, u32)| {
            self.state.map.iter().any(|cell| (cell.solver, cell.vertices) == (*solver, *vertices))
        };
        let missing: Vec<_> = columns.filter(|column| !is_there(column)).collect();
        let bar = bar(missing.len() as u64, "{bar:40} {pos} of {len} panels of the map: {msg}");
        for (solver, vertices) in missing {
            let begun = Instant::now();
            bar.set_message(format!("{}, {vertices} vertices", solver.name()));
            self.state.map.extend(column(&mut *self.gpus[0].backend, solver, vertices)?);
            self.keep(begun)?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(())
    }

    /// Plays cases until it has run for so long in all.
    ///
    /// # Errors
    /// A device is lost for good, or a file cannot be written.
    pub fn for_seconds(&mut self, seconds: f64) -> Result<()> {
        let bar = bar(seconds as u64, "{bar:40} {pos} of {len} s, {msg}");
        while self.state.seconds < seconds {
            bar.set_position(self.state.seconds as u64);
            self.next(&bar)?;
        }
        bar.finish_and_clear();
        Ok(())
    }

    /// Plays so many cases.
    ///
    /// # Errors
    /// As [`Run::for_seconds`].
    pub fn cases(&mut self, count: u64) -> Result<()> {
        let bar = bar(count, "{bar:40} {pos} of {len} cases, {msg}");
        for _ in 0..count {
            self.next(&bar)?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(())
    }

    fn next(&mut self, bar: &ProgressBar) -> Result<()> {
        let (begun, index) = (Instant::now(), self.state.next);
        let seed = Dice::new(self.state.settings.seed).case(index);
        let solvers = &self.state.settings.solvers;
        let solver = solvers[index as usize % solvers.len()];
        bar.set_message(format!(
            "case {index} (seed {seed}, {}), {} failures",
            solver.name(),
            self.state.failures.len()
        ));
        let turn = index / solvers.len() as u64;
        let first = turn as usize % self.gpus.len();
        let is_compared = self.gpus.len() > 1 && turn.is_multiple_of(COMPARED);
        let mut verdict = judge(&mut self.gpus[first], seed, solver, Part::ALL)?;
        if is_compared {
            let second = (first + 1) % self.gpus.len();
            let other = judge(&mut self.gpus[second], seed, solver, Part::ALL)?;
            compare(&mut verdict, &other);
        }
        self.state.tallies.entry(solver).or_default().add(seed, &verdict, is_compared);
        for trouble in verdict.troubles {
            self.fail(bar, first, Failure { solver, backend: self.gpus[first].name, seed, part: Part::ALL, trouble })?;
        }
        self.state.next += 1;
        self.keep(begun)
    }

    fn fail(&mut self, bar: &ProgressBar, gpu: usize, failure: Failure) -> Result<()> {
        bar.suspend(|| eprintln!("{failure}"));
        let same = |kept: &&Failure| (kept.solver, kept.trouble.kind()) == (failure.solver, failure.trouble.kind());
        if self.state.failures.iter().filter(same).count() >= self.made_smaller {
            self.state.failures.push(failure);
            return Ok(());
        }
        let smaller = minimised(&mut self.gpus[gpu], failure)?;
        bar.suspend(|| eprintln!("  smaller: {smaller}"));
        self.state.failures.push(smaller);
        Ok(())
    }

    fn keep(&mut self, begun: Instant) -> Result<()> {
        self.state.seconds += begun.elapsed().as_secs_f64();
        self.path.as_deref().map_or(Ok(()), |path| self.state.write(path))
    }
}

/// Adds what the other backend has to say.
fn compare(verdict: &mut Verdict, other: &Verdict) {
    let news = other.troubles.iter().filter(|trouble| verdict.troubles.iter().all(|own| own.kind() != trouble.kind()));
    let news: Vec<_> = news.cloned().collect();
    verdict.troubles.extend(news);
    let is_whole = |verdict: &Verdict| {
        !verdict.troubles.iter().any(|trouble| matches!(trouble, Trouble::Panic(_) | Trouble::Broken(_)))
    };
    if is_whole(verdict) && verdict.fingerprint != other.fingerprint {
        verdict.troubles.push(Trouble::Backends);
    }
}

fn bar(length: u64, template: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(template).expect("the template is fixed");
    let bar = ProgressBar::new(length).with_style(style);
    bar.enable_steady_tick(Duration::from_secs(1));
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> Settings {
        Settings { seed: 3, solvers: vec![SolverName::Direct], backends: vec![BackendName::Wgpu] }
    }

    #[test]
    fn a_run_goes_on_where_it_was_stopped_and_another_one_begins_anew() {
        let path = std::env::temp_dir().join(format!("tressfx-stress-{}.json", std::process::id()));
        let mut state = State::resume(&path, settings()).unwrap();
        assert_eq!((state.next, state.tallies.len()), (0, 0));
        state.next = 9;
        state.seconds = 12.5;
        state.tallies.entry(SolverName::Direct).or_default().add(4, &Verdict::default(), true);
        state.write(&path).unwrap();
        assert_eq!(State::resume(&path, settings()).unwrap(), state);
        assert_eq!(State::resume(&path, Settings { seed: 4, ..settings() }).unwrap().next, 0);
        State { program: String::from("another"), ..state }.write(&path).unwrap();
        assert_eq!(State::resume(&path, settings()).unwrap().next, 0);
        fs::remove_file(path).unwrap();
    }

    #[test]
    fn other_bits_are_found() {
        let one = || Verdict { fingerprint: 1, ..Verdict::default() };
        let (mut equal, mut other) = (one(), one());
        compare(&mut equal, &one());
        compare(&mut other, &Verdict { fingerprint: 2, ..Verdict::default() });
        assert!(equal.troubles.is_empty());
        assert_eq!(other.troubles, [Trouble::Backends]);
    }
}
