//! Errors held against those that are stored.

use anyhow::{Result, bail};

use crate::figures::{Row, Run};

/// How much an error may grow.
const GROWTH: f64 = 1.1;
/// What an error may grow by in any case, since figures near 0 are rounding: FLIP, share of the root mean square, steps of 8 bits.
const SLACK: [f64; 3] = [1e-5, 1e-5, 1.0];

/// Says which errors have grown.
///
/// # Errors
/// If one has grown by more than 10 %, or if there is nothing to compare.
pub(crate) fn check(stored: &Run, run: &Run) -> Result<()> {
    stored.check_setting(run.setting)?;
    let before = |row: &Row| stored.rows.iter().find(|old| (&old.scene, &old.method) == (&row.scene, &row.method));
    let pairs: Vec<_> = run.rows.iter().filter_map(|row| Some((before(row)?, row))).collect();
    if pairs.is_empty() {
        bail!("none of the {} stored figures is of the same scene and method", stored.rows.len());
    }
    let grown: Vec<String> = pairs.iter().flat_map(|(old, new)| grown(old, new)).collect();
    println!("{} of {} rows compared, {} errors have grown", pairs.len(), run.rows.len(), grown.len());
    if grown.is_empty() {
        return Ok(());
    }
    bail!("errors have grown by more than 10 %:\n{}", grown.join("\n"))
}

fn grown(old: &Row, new: &Row) -> Vec<String> {
    let errors = |row: &Row| [row.flip, row.rms(), f64::from(row.largest)];
    let names = ["FLIP", "root mean square", "largest difference"];
    let figures = names.into_iter().zip(errors(old)).zip(errors(new)).zip(SLACK);
    let said = figures.filter(|(((_, old), new), slack)| *new > old * GROWTH + slack);
    said.map(|(((name, before), after), _)| {
        format!("  {}, {}, {}: {name} {before:.6} -> {after:.6}", new.scene, new.method, new.backend)
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::Extent;
    use crate::figures::tests::row;

    fn run(rows: Vec<Row>) -> Run {
        Run { setting: Extent::Quick.setting(), rows, changes: Vec::new(), note: None }
    }

    #[test]
    fn what_grows_a_little_passes_and_what_grows_more_is_named() {
        let stored = run(vec![row("tiles", 0.01, 1.0), row("ppll", 0.02, 1.0)]);
        check(&stored, &run(vec![row("tiles", 0.0109, 9.0)])).unwrap();
        let worse = Row { psnr_db: Some(39.0), ..row("ppll", 0.0225, 1.0) };
        let error = check(&stored, &run(vec![row("tiles", 0.005, 1.0), worse])).unwrap_err().to_string();
        assert!(error.contains("curly-near, ppll, wgpu: FLIP 0.020000 -> 0.022500"), "{error}");
        assert!(error.contains("root mean square") && !error.contains("tiles"), "{error}");
    }

    #[test]
    fn what_cannot_be_compared_is_no_success() {
        let stored = run(vec![row("tiles", 0.01, 1.0)]);
        assert!(check(&stored, &run(vec![row("ppll", 0.01, 1.0)])).is_err());
        let larger = Run { setting: Extent::Full.setting(), ..stored.clone() };
        assert!(check(&stored, &larger).unwrap_err().to_string().contains("320"));
    }
}
