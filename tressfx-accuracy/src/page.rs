//! The page that people read.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context, Result};

use crate::change;
use crate::figures::{Extent, Row, Run};
use crate::plot;

/// Writes `README.md`, or `light.md`.
pub(crate) fn write(run: &Run, extent: Extent, docs: &Path) -> Result<()> {
    let (name, text) = match extent {
        Extent::Light => ("light.md", light(run)),
        Extent::Quick | Extent::Full => ("README.md", page(run, extent)),
    };
    let path = docs.join(name);
    std::fs::write(&path, text).with_context(|| path.display().to_string())
}

/// The page of shadows: a table, a row a scene.
fn light(run: &Run) -> String {
    let [width, height] = run.setting.size;
    let mut page = format!(
        "# The error of shadows\n\n\
         Made by `cargo xtask accuracy --light`; with `--check` it measures again and fails where an error has grown by more than 10 %. \
         Each picture is compared with that of the reference renderer (`tressfx render --reference`), which traces rays with {} samples a \
         pixel through fibres as solids, and from what they meet to each light and into the sky, at {width}x{height}. All methods blend \
         by `--oit tiles --places 4`, but for `nearest`, which the reference renderer draws (`--reference-light nearest`): the method of TressFX 4.1, \
        light by the distance behind the nearest fibre that a light sees, in maps of 2048x2048, with so many radii from one fibre to the next. \
        What is opaque is traced for it, and nothing shades the sky. A groom is seen as it is in its file, and after {} frames of a head that is shaken. \
         Mean FLIP of the whole picture, of {} bits a channel, and PSNR in dB behind it:\n\n",
        run.setting.samples, run.setting.frames, run.setting.bits
    );
    let mut methods: Vec<(&str, u64)> = Vec::new();
    for row in &run.rows {
        if methods.iter().all(|(name, _)| *name != row.method) {
            methods.push((&row.method, row.bytes));
        }
    }
    let cells = |of: &dyn Fn(&str) -> String| methods.iter().map(|(name, _)| of(name)).collect::<Vec<_>>().join(" | ");
    let _ = writeln!(page, "| scene | {} |\n|---|{}", cells(&|name| name.to_owned()), "---|".repeat(methods.len()));
    for scene in run.scenes() {
        let figure = |name: &str| {
            let row = run.of_scene(scene).find(|row| row.method == name);
            row.map_or_else(
                || "-".to_owned(),
                |row| format!("{:.4}, {:.1}", row.flip, row.psnr_db.unwrap_or(f64::INFINITY)),
            )
        };
        let _ = writeln!(page, "| {scene} | {} |", cells(&figure));
    }
    let bytes = methods.iter().map(|(name, bytes)| match name.starts_with("nearest") {
        true => "-".to_owned(),
        false => format!("{:.1} MB", *bytes as f64 * 1e-6),
    });
    let _ = writeln!(page, "| memory of shadows | {} |", bytes.collect::<Vec<_>>().join(" | "));
    page + &change::page(&run.changes)
}

fn page(run: &Run, extent: Extent) -> String {
    let quick = if extent == Extent::Quick { " --quick" } else { "" };
    let [width, height] = run.setting.size;
    let mut page = format!(
        "# Error against run time\n\n\
         Made by `cargo xtask accuracy{quick}`, which also makes [accuracy.json](accuracy.json): the same figures, with the time \
         of each pass.\n\
         `cargo xtask accuracy{quick} --check` measures again and fails where an error has grown by more than 10 %.\n\n\
         Each picture is compared with that of the reference renderer (`tressfx render --reference --reference-light given`), \
         which traces fibres as solids with {} rays a pixel, in the colours that the methods draw with, at {width}x{height}; \
         frames simulated: {}. FLIP, PSNR and the largest difference (of 255) are of \
         the whole picture, with its backdrop, of {} bits a channel. A part of each error is the sampling of the reference, the same for all methods of \
         a scene. Milliseconds are those of shading and of the technique; shadows are in [light.md](light.md).\n\n",
        run.setting.samples, run.setting.frames, run.setting.bits
    );
    page.push_str(&devices(run));
    if let Some(note) = &run.note {
        let _ = write!(page, "\n{note}\n");
    }
    for scene in run.scenes() {
        let rows: Vec<&Row> = run.of_scene(scene).collect();
        let _ = write!(page, "\n## {scene}\n\n{}\n{}", picture(scene, &rows), table(&rows));
    }
    page
}

/// On which devices the times were taken, and whether they say something of GPUs.
fn devices(run: &Run) -> String {
    let devices: BTreeSet<_> = run.rows.iter().map(|row| (&row.backend, &row.adapter, row.is_software())).collect();
    let of = |(backend, adapter, is_software): (&String, &String, bool)| match is_software {
        false => format!("* {backend}: times were taken on {adapter}.\n"),
        true => format!(
            "* {backend}: times were taken on {adapter}, which is **a CPU that plays a GPU**. They say nothing of the times on a \
             GPU, nor of their order. Mesa's ends a shader after 65,535 rounds of its loops: tiles end before, and count what they leave out \
             as dropped.\n"
        ),
    };
    devices.into_iter().map(of).collect()
}

fn picture(scene: &str, rows: &[&Row]) -> String {
    match plot::is_drawn(rows) {
        true => format!("![FLIP against milliseconds]({scene}.svg)\n"),
        false => String::from("The device cannot time passes.\n"),
    }
}

fn table(rows: &[&Row]) -> String {
    let mut table = String::from(
        "| method | backend | FLIP | PSNR, dB | largest | ms | fragments | dropped | MB |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    for row in rows {
        let psnr = row.psnr_db.map_or_else(|| String::from("equal"), |decibels| format!("{decibels:.2}"));
        let ms = row.ms().map_or_else(|| String::from("-"), |ms| format!("{ms:.3}"));
        let cpu = if row.is_software() { " (CPU)" } else { "" };
        let _ = writeln!(
            table,
            "| {} | {} | {:.5} | {psnr} | {} | {ms}{cpu} | {} | {} | {:.1} |",
            row.method,
            row.backend,
            row.flip,
            row.largest,
            row.fragments,
            row.dropped,
            row.bytes as f64 * 1e-6
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
        let cpu = Row { adapter: "llvmpipe (LLVM)".into(), ..row("tiles", 0.125, 0.5) };
        let untimed = Row { passes: Vec::new(), psnr_db: None, ..row("tiles", 0.125, 0.5) };
        let of = |row: Row| {
            page(
                &Run { setting: Extent::Quick.setting(), rows: vec![row], changes: Vec::new(), note: None },
                Extent::Quick,
            )
        };
        let (software, hardware, untimed) = (of(cpu), of(row("tiles", 0.125, 0.5)), of(untimed));
        assert!(software.contains("a CPU that plays a GPU") && software.contains("| 0.500 (CPU) |"), "{software}");
        assert!(!hardware.contains("CPU") && hardware.contains("| tiles | wgpu | 0.12500 | 40.00 | 30 | 0.500 |"));
        assert!(hardware.contains("(curly-near.svg)") && hardware.contains("--quick --check"));
        let lit = light(&Run {
            setting: Extent::Light.setting(),
            rows: vec![super::tests::row("no-shadows", 0.125, 0.5)],
            changes: Vec::new(),
            note: None,
        });
        assert!(lit.contains("| scene | no-shadows |\n|---|---|\n| curly-near | 0.1250, 40.0 |"), "{lit}");
        assert!(untimed.contains("| equal | 30 | - |") && !untimed.contains(".svg"), "{untimed}");
    }
}
