//! Errors held against those that are stored.

use anyhow::{Result, bail};

use crate::figures::{Row, Run};

/// How much an error may grow.
const GROWTH: f64 = 1.1;
/// What an error may grow by in any case, since figures near 0 are rounding: of edges, distances and jitter, as shares.
const SLACK: f64 = 2e-6;

/// Says which errors have grown.
///
/// # Errors
/// If one has grown by more than 10 %, or if there is nothing to compare.
pub(crate) fn check(stored: &Run, run: &Run) -> Result<()> {
    if stored.setting != run.setting {
        bail!("the stored figures are of {:?}, these of {:?}", stored.setting, run.setting);
    }
    let before = |row: &Row| stored.rows.iter().find(|old| old.case == row.case && old.method() == row.method());
    let pairs: Vec<_> = run.rows.iter().filter_map(|row| Some((before(row)?, row))).collect();
    if pairs.is_empty() {
        bail!("none of the {} stored figures is of the same case and method", stored.rows.len());
    }
    let grown: Vec<String> = pairs.iter().flat_map(|(old, new)| grown(old, new)).collect();
    println!("{} of {} rows compared, {} errors have grown", pairs.len(), run.rows.len(), grown.len());
    if grown.is_empty() {
        return Ok(());
    }
    bail!("errors have grown by more than 10 %:\n{}", grown.join("\n"))
}

fn errors(row: &Row) -> [(&'static str, Option<f64>); 7] {
    [
        ("edges", Some(row.edges)),
        ("distance", Some(row.distance)),
        ("energy", row.energy.map(f64::abs)),
        ("frame rate", row.frame_rate),
        ("sub-step", row.sub_step),
        ("resolution", row.resolution),
        ("jitter", row.jitter),
    ]
}

fn grown(old: &Row, new: &Row) -> Vec<String> {
    let pairs = errors(old).into_iter().zip(errors(new));
    let said = pairs.filter_map(|((name, before), (_, after))| {
        let (before, after) = before.zip(after)?;
        // What is not a number has grown too.
        let is_fine = after <= before * GROWTH + SLACK;
        (!is_fine).then(|| format!("  {}, {}: {name} {before:.3e} -> {after:.3e}", new.case, new.method()))
    });
    said.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::Extent;
    use crate::figures::tests::row;

    fn run(rows: Vec<Row>) -> Run {
        Run { setting: Extent::Quick.setting(), rows }
    }

    #[test]
    fn what_grows_a_little_passes_and_what_grows_more_is_named() {
        let stored = run(vec![row(60, 0.04, 0.5), row(120, 0.01, 1.0)]);
        check(&stored, &run(vec![row(120, 0.0109, 9.0)])).unwrap();
        let worse = Row { jitter: Some(f64::NAN), ..row(60, 0.05, 0.5) };
        let error = check(&stored, &run(vec![row(120, 0.005, 1.0), worse])).unwrap_err().to_string();
        assert!(error.contains("direct 60/s, 2 rounds, 64 vertices: distance 4.000e-2 -> 5.000e-2"), "{error}");
        assert!(error.contains("jitter") && !error.contains("120/s"), "{error}");
    }

    #[test]
    fn what_cannot_be_compared_is_no_success() {
        let stored = run(vec![row(60, 0.04, 0.5)]);
        assert!(check(&stored, &run(vec![row(240, 0.01, 1.0)])).is_err());
        let larger = Run { setting: Extent::Full.setting(), ..stored.clone() };
        assert!(check(&stored, &larger).unwrap_err().to_string().contains("timed"));
    }
}
