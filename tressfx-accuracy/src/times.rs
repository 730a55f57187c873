//! Run times taken anew, for when a change has left the pictures as they were: the reference renderer has nothing to draw, and errors stay.

use std::fs;

use anyhow::{Context, Result, bail};
use indicatif::ProgressBar;

use crate::figures::{Row, Run};
use crate::measure::{self, Measure};
use crate::method::Method;
use crate::scene::Scene;

/// Counts of fragments within this share of each other are of one picture but for roundings, of vertices that a solver moves.
const ROUNDING: f64 = 1e-4;

/// The run with the times, fragments and bytes of these methods on these scenes as they are now. A row whose count of fragments is another one stays
/// as it was, and is named: its picture has changed.
pub(crate) fn anew(measure: &Measure, run: Run, scenes: &[Scene], methods: &[Method]) -> Result<Run> {
    let bar = ProgressBar::new(run.rows.len() as u64);
    let mut words: Option<(String, Vec<String>)> = None;
    let mut rows = Vec::new();
    for row in run.rows {
        bar.inc(1);
        let scene = scenes.iter().find(|scene| scene.name == row.scene);
        let method = methods.iter().find(|method| method.name == row.method);
        let (Some(scene), Some(method)) = (scene, method) else {
            rows.push(row);
            continue;
        };
        let Some(groom) = scene.groom.as_deref() else {
            eprintln!("skipped: {}, {}: TRESSFX_ASSETS is not set", row.scene, row.method);
            rows.push(row);
            continue;
        };
        let of_scene = match words.take() {
            Some((name, words)) if name == scene.name => words,
            _ => measure.words(groom, scene)?,
        };
        rows.push(timed(measure, row, &of_scene, method)?);
        words = Some((scene.name.clone(), of_scene));
    }
    bar.finish_and_clear();
    Ok(Run { rows, ..run })
}

/// A row with what a method takes now.
fn timed(measure: &Measure, row: Row, words: &[String], method: &Method) -> Result<Row> {
    let folder = measure.work.join("times");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let on = ["--backend".to_owned(), row.backend.clone()];
    let stats = measure.program.measure(&[words, &method.words, &on].concat(), &folder.join("picture.png"))?;
    let now = Row {
        adapter: stats.adapter.clone(),
        passes: measure::passes(&stats, false),
        fragments: stats.render.fragments,
        dropped: stats.render.dropped,
        bytes: stats.render.oit_bytes,
        ..row.clone()
    };
    if now.device() != row.device() {
        bail!("{:?} measures, {:?} did: their times cannot be compared", now.device(), row.device());
    }
    let (was, is) = (row.fragments, now.fragments);
    if is.abs_diff(was) as f64 <= ROUNDING * was as f64 && now.dropped == row.dropped {
        return Ok(now);
    }
    eprintln!(
        "{}, {}: {is} fragments in place of {was}: its picture is another one, and its row stays",
        row.scene, row.method
    );
    Ok(row)
}
