//! The measurement. What an interrupted run has measured is not measured again; a run that comes to its end leaves nothing behind.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, UNIX_EPOCH};

use anyhow::{Context, Result};
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};
use tressfx_core::backend::Run as Gpu;

use crate::Device;
use crate::case::{Answer, Case, FPS, cases};
use crate::drive::{Drive, Tips, distance};
use crate::figures::{Extent, Row};
use crate::method::{Method, methods};
use crate::truth::{Truth, truth};

/// Pairs of frames that are timed.
const PAIRS: u32 = 6;
/// What a GPU is given to do before that.
const WARM_UP: Duration = Duration::from_secs(1);

/// What is measured with, and where rows are kept.
pub(crate) struct Measure {
    device: Device,
    work: PathBuf,
    extent: Extent,
    /// Changes when this program is built anew.
    stamp: String,
}

/// A row of an interrupted run, what it was measured with, and the tips that other rows are compared with.
#[derive(Deserialize, Serialize)]
struct Kept {
    stamp: String,
    method: Method,
    row: Row,
    tips: Tips,
}

impl Measure {
    pub(crate) fn new(device: Device, work: &Path, extent: Extent) -> Result<Self> {
        let program = std::env::current_exe()?;
        let about = fs::metadata(&program).with_context(|| program.display().to_string())?;
        let changed = about.modified()?.duration_since(UNIX_EPOCH)?.as_nanos();
        let work = work.join(format!("{}-{device:?}", extent.name()).to_lowercase());
        fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
        Ok(Self { device, work, extent, stamp: format!("{} bytes, {changed}", about.len()) })
    }

    /// Every method on every case whose strands are there.
    pub(crate) fn all(&self) -> Result<Vec<Row>> {
        let (cases, methods) = (cases(self.extent), methods(self.extent));
        let (there, missing): (Vec<_>, Vec<_>) = cases.iter().partition(|case| case.source.is_some());
        for case in missing {
            eprintln!("skipped: {}: TRESSFX_ASSETS is not set", case.name);
        }
        let style = "{bar:40} {pos} of {len}, {eta} left: {msg}";
        let bar = ProgressBar::new((there.len() * methods.len()) as u64)
            .with_style(ProgressStyle::with_template(style).expect("the template is fixed"));
        let mut gpu = self.device.open()?;
        let (mut rows, mut files) = (Vec::new(), Vec::new());
        for case in there {
            let mut answer = None;
            let mut of_case = Vec::new();
            for method in &methods {
                bar.set_message(format!("{}, {method:?}", case.name));
                let file = self.work.join(format!("{}-{}.json", case.name, file_name(method)));
                of_case.push(self.kept(&mut *gpu, &file, case, method, &mut answer)?);
                files.push(file);
                bar.inc(1);
            }
            compare(&mut of_case);
            rows.extend(of_case.into_iter().map(|kept| kept.row));
        }
        bar.finish_and_clear();
        files.iter().try_for_each(|path| fs::remove_file(path).with_context(|| path.display().to_string()))?;
        Ok(rows)
    }

    /// What was kept, or what is measured now. The answer to the case is found when it is first needed.
    fn kept(
        &self,
        gpu: &mut dyn Gpu,
        file: &Path,
        case: &Case,
        method: &Method,
        answer: &mut Option<Truth>,
    ) -> Result<Kept> {
        let earlier = fs::read_to_string(file).ok().and_then(|text| serde_json::from_str::<Kept>(&text).ok());
        if let Some(earlier) = earlier.filter(|kept| (&kept.stamp, &kept.method) == (&self.stamp, method)) {
            return Ok(earlier);
        }
        let answer = match answer {
            Some(answer) => answer,
            None => {
                let strands = case.strands(self.sample(case), None)?;
                answer.insert(truth(case, &strands, self.extent.setting().reference_rate)?)
            }
        };
        let (row, tips) = self.row(gpu, case, method, answer).with_context(|| format!("{}, {method:?}", case.name))?;
        let kept = Kept { stamp: self.stamp.clone(), method: *method, row, tips };
        fs::write(file, serde_json::to_string(&kept)?).with_context(|| file.display().to_string())?;
        Ok(kept)
    }

    /// Strands with known answers are all alike.
    fn sample(&self, case: &Case) -> u32 {
        if case.answer == Answer::ShortSteps { self.extent.setting().sample } else { 1 }
    }

    fn row(&self, gpu: &mut dyn Gpu, case: &Case, method: &Method, answer: &Truth) -> Result<(Row, Tips)> {
        let adapter = gpu.caps().adapter.clone();
        let all = case.strands(self.extent.setting().timed, method.vertices)?;
        Drive::new(gpu, &all, case, method)?.warm_up(WARM_UP)?;
        let ms = Drive::new(gpu, &all, case, method)?.milliseconds(PAIRS)?;
        let some = case.strands(self.sample(case), method.vertices)?;
        let (tips, edges) = Drive::new(gpu, &some, case, method)?.tips(FPS, case.frames, case.after, 2)?;
        let mut at_rate = |fps: u32| -> Result<Tips> {
            // Sixths of a second are whole frames and whole sub-steps.
            Ok(Drive::new(gpu, &some, case, method)?.tips(fps, case.frames * fps / FPS, 0, fps / 6)?.0)
        };
        let is_groom = case.answer == Answer::ShortSteps;
        let frame_rate = match is_groom && method.is_default() {
            true => {
                let (slow, usual, fast) = (at_rate(30)?, at_rate(FPS)?, at_rate(144)?);
                Some(distance(&slow, &usual).max(distance(&fast, &usual)))
            }
            false => None,
        };
        let jitter = is_groom.then(|| Drive::new(gpu, &some, case, method)?.jitter()).transpose()?;
        let falls = case.answer == Answer::Links;
        let energy = falls.then(|| Drive::new(gpu, &some, case, method)?.energy(method)).transpose()?;
        let row = Row {
            case: case.name.to_owned(),
            solver: method.family.name().to_owned(),
            rate: method.rate,
            rounds: method.rounds,
            vertices: some.vertices,
            adapter,
            ms,
            timed: all.guides,
            edges,
            distance: distance(&tips, &answer.tips),
            reference: answer.converged,
            energy,
            frame_rate,
            sub_step: None,
            resolution: None,
            jitter,
        };
        Ok((row, tips))
    }
}

/// What needs other rows of the same case: the method with half of the sub-step, and that with the most vertices.
fn compare(of_case: &mut [Kept]) {
    for i in 0..of_case.len() {
        let Method { family, rate, rounds, vertices } = of_case[i].method;
        let find = |method: Method| of_case.iter().find(|kept| kept.method == method);
        let halved = find(Method { family, rate: 2 * rate, rounds, vertices });
        let sub_step = halved.map(|halved| distance(&of_case[i].tips, &halved.tips));
        let alike = of_case.iter().filter(|kept| (kept.method.family, kept.method.rate) == (family, rate));
        let finest = alike.filter(|kept| kept.method.vertices.is_some()).max_by_key(|kept| kept.row.vertices);
        let resolution = finest
            .filter(|finest| vertices.is_some() && finest.row.vertices > of_case[i].row.vertices)
            .map(|finest| distance(&of_case[i].tips, &finest.tips));
        of_case[i].row.sub_step = sub_step;
        of_case[i].row.resolution = resolution;
    }
}

fn file_name(method: &Method) -> String {
    let vertices = method.vertices.map_or(String::new(), |vertices| format!("-v{vertices}"));
    format!("{}-{}-r{}{vertices}", method.family.name(), method.rate, method.rounds)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::figures::tests::row;
    use crate::method::Family;

    fn kept(rate: u32, vertices: Option<u32>, at: f64) -> Kept {
        let method = Method { family: Family::Direct, rate, rounds: 2, vertices };
        let row = Row { vertices: vertices.unwrap_or(32), ..row(rate, 0.1, 1.0) };
        Kept { stamp: String::new(), method, row, tips: vec![vec![DVec3::X * at]] }
    }

    #[test]
    fn rows_are_compared_with_half_of_the_sub_step_and_with_the_most_vertices() {
        let mut rows = [kept(60, None, 1.0), kept(120, None, 1.25), kept(120, Some(8), 2.0), kept(120, Some(64), 1.5)];
        compare(&mut rows);
        assert_eq!(rows.each_ref().map(|kept| kept.row.sub_step), [Some(0.25), None, None, None]);
        assert_eq!(rows.each_ref().map(|kept| kept.row.resolution), [None, None, Some(0.5), None]);
    }
}
