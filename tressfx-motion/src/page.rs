//! The page that people read.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result};

use crate::figures::{Extent, Row, Run};
use crate::plot;

/// Writes `motion.md`.
pub(crate) fn write(run: &Run, extent: Extent, docs: &Path) -> Result<()> {
    let path = docs.join("motion.md");
    std::fs::write(&path, page(run, extent)).with_context(|| path.display().to_string())
}

fn page(run: &Run, extent: Extent) -> String {
    let quick = if extent == Extent::Quick { " --quick" } else { "" };
    let setting = &run.setting;
    let mut page = format!(
        "# Error of motion against run time\n\n\
         Made by `cargo xtask accuracy --motion{quick}`, which also makes [motion.json](motion.json).\n\
         `cargo xtask accuracy --motion{quick} --check` measures again and fails where an error has grown by more than 10 %.\n\n\
         * **chain**: a strand of 20 cm and a bending length of 1 cm, released from the horizontal; against 48 rigid links by the \
         Runge-Kutta method, until 0.3 s.\n\
         * **cantilever**: a strand of two bending lengths, clamped horizontally; against the heavy elastica, after 4 s.\n\
         * **grooms**: a second of a shake (2 g, 4 Hz) or of a wind (4 m/s, in gusts), without colliders, with default parameters; {} strands \
         against the f64 function of `direct` with {} sub-steps a second. `tressfx` has parameters of its own and no material, so \
         that its distance is also that of its law of motion.\n\n\
         All distances are root mean squares over strands and over every thirtieth of a second, in % of the length of the strand. \
         *frame rate*: the larger distance of 30 and 144 frames a second to 60. *sub-step*: the distance to half of the sub-step. \
         *resolution*: the distance to 64 vertices. *jitter*: the most that a vertex moves in a frame after 3 s of rest, as a share \
         of its strand. *energy*: what it has changed by after 1 s, in % of what the fall sets free; velocities are those of \
         whole sub-steps, so that long ones show less than they have. *ms*: GPU time of 1/60 s of motion.\n\n",
        setting.sample, setting.reference_rate
    );
    page.push_str(&devices(run));
    for case in run.cases() {
        let rows: Vec<&Row> = run.of_case(case).collect();
        let _ = write!(page, "\n## {case}\n\n{}{}\n{}", picture(case, &rows), notes(&rows), table(&rows));
    }
    page
}

/// On which devices the times were taken, and whether they say something of GPUs.
fn devices(run: &Run) -> String {
    let devices: BTreeSet<_> = run.rows.iter().map(|row| (&row.adapter, row.is_software())).collect();
    let of = |(adapter, is_software): (&String, bool)| match is_software {
        false => format!("Times were taken on {adapter}.\n"),
        true => format!(
            "Times were taken on {adapter}, which is **a CPU that plays a GPU**. They say nothing of the times on a GPU.\n"
        ),
    };
    devices.into_iter().map(of).collect()
}

fn picture(case: &str, rows: &[&Row]) -> String {
    match plot::is_drawn(rows) {
        true => format!("![Distance against milliseconds](motion-{case}.svg)\n\n"),
        false => String::from("The device cannot time passes.\n\n"),
    }
}

fn notes(rows: &[&Row]) -> String {
    let Some(row) = rows.first() else { return String::new() };
    let converged = row.reference.map_or(String::new(), |reference| {
        format!(" The reference is {:.4} % from that with sub-steps of twice the length.", 100.0 * reference)
    });
    format!("Strands that were timed: {}.{converged}\n", row.timed)
}

fn table(rows: &[&Row]) -> String {
    let mut table = String::from(
        "| solver | sub-steps/s | rounds | vertices | ms | edges | distance, % | frame rate, % | sub-step, % | resolution, % | energy, % \
         | jitter |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let percent = |share: Option<f64>| share.map_or(String::from("-"), |share| format!("{:.3}", 100.0 * share));
    for row in rows {
        let cpu = if row.is_software() { " (CPU)" } else { "" };
        let ms = row.ms.map_or_else(|| String::from("-"), |ms| format!("{ms:.3}{cpu}"));
        let jitter = row.jitter.map_or_else(|| String::from("-"), |jitter| format!("{jitter:.1e}"));
        let _ = writeln!(
            table,
            "| {} | {} | {} | {} | {ms} | {:.1e} | {} | {} | {} | {} | {} | {jitter} |",
            row.solver,
            row.rate,
            row.rounds,
            row.vertices,
            row.edges,
            percent(Some(row.distance)),
            percent(row.frame_rate),
            percent(row.sub_step),
            percent(row.resolution),
            percent(row.energy),
        );
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::tests::row;

    #[test]
    fn times_of_a_cpu_are_called_so_on_the_page_and_in_the_table() {
        let cpu = Row { adapter: "llvmpipe (LLVM)".into(), ..row(120, 0.125, 0.5) };
        let untimed = Row { ms: None, ..row(120, 0.125, 0.5) };
        let of = |row: Row| page(&Run { setting: Extent::Quick.setting(), rows: vec![row] }, Extent::Quick);
        let (software, hardware, untimed) = (of(cpu), of(row(120, 0.125, 0.5)), of(untimed));
        assert!(software.contains("a CPU that plays a GPU") && software.contains("| 0.500 (CPU) |"), "{software}");
        assert!(!hardware.contains("CPU") && hardware.contains("| direct | 120 | 2 | 64 | 0.500 | 1.0e-6 | 12.500 |"));
        assert!(hardware.contains("(motion-curly-shake.svg)") && hardware.contains("0.0100 % from"), "{hardware}");
        assert!(untimed.contains("| 64 | - |") && !untimed.contains(".svg"), "{untimed}");
    }
}
