//! How the time of techniques grows with what is seen: one hairstyle of more and more strands.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use indicatif::ProgressBar;
use serde::{Deserialize, Serialize};

use crate::figures::{self, Extent, PassTime};
use crate::growth_plot;
use crate::measure;
use crate::method::{self, Method};
use crate::program::Program;

/// Strands of `builtin:long`, of 32 vertices each.
const STRANDS: [u32; 6] = [4096, 8192, 16_384, 32_768, 65_536, 131_072];

/// One of each technique, by the name of [`method::methods`].
const METHODS: [&str; 4] = ["ppll-k8", "ppll-skip-hidden-k8", "shortcut-mean-k3", "tiles"];

/// Frames that are drawn: what is measured are medians, and tiles learn in the first ones what hair hides.
const FRAMES: u32 = 240;

/// Pixels.
const SIZE: [u32; 2] = [1920, 1080];

/// All of them, and where they were measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Growth {
    pub(crate) backend: String,
    pub(crate) adapter: String,
    /// Pixels.
    pub(crate) size: [u32; 2],
    pub(crate) frames: u32,
    pub(crate) points: Vec<Point>,
}

/// One method with so many strands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Point {
    pub(crate) method: String,
    pub(crate) strands: u32,
    /// Of the passes that draw hair.
    pub(crate) passes: Vec<PassTime>,
    /// Of the last frame: tiles make what is seen alone, others all.
    pub(crate) fragments: u64,
    pub(crate) dropped: u64,
    /// Of the buffers in which the technique keeps fragments and pixels.
    pub(crate) bytes: u64,
}

impl Point {
    /// Milliseconds of a frame's hair; 0 where the device cannot time passes.
    pub(crate) fn ms(&self) -> f64 {
        figures::sum_of(&self.passes).unwrap_or(0.0)
    }
}

impl Growth {
    pub(crate) fn read(path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
        serde_json::from_str(&text).with_context(|| path.display().to_string())
    }

    /// The points of a method, in the order of strands.
    pub(crate) fn of<'a>(&'a self, method: &'a str) -> impl Iterator<Item = &'a Point> {
        self.points.iter().filter(move |point| point.method == method)
    }

    /// The methods, in their order.
    pub(crate) fn methods(&self) -> Vec<&str> {
        let mut methods: Vec<&str> = self.points.iter().map(|point| point.method.as_str()).collect();
        methods.dedup();
        methods
    }

    /// Time of 131,072 strands as a multiple of that of 16,384; none where the device cannot time passes.
    fn eightfold(&self, method: &str) -> Option<f64> {
        let ms = |strands| self.of(method).find(|point| point.strands == strands).map_or(f64::NAN, Point::ms);
        let times = ms(131_072) / ms(16_384);
        times.is_finite().then_some(times)
    }
}

/// Measures all, on one backend.
pub(crate) fn measure(program: &Program, backend: &str, work: &Path) -> Result<Growth> {
    let folder = work.join("growth");
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let methods = method::named(method::methods(Extent::Full), &METHODS.map(str::to_owned))?;
    let bar = ProgressBar::new((methods.len() * STRANDS.len()) as u64);
    let mut growth =
        Growth { backend: String::new(), adapter: String::new(), size: SIZE, frames: FRAMES, points: Vec::new() };
    for method in &methods {
        for strands in STRANDS {
            let stats = program.measure(&words(method, strands, backend), &folder.join("picture.png"))?;
            growth.points.push(Point {
                method: method.name.clone(),
                strands,
                passes: measure::passes(&stats, false),
                fragments: stats.render.fragments,
                dropped: stats.render.dropped,
                bytes: stats.render.oit_bytes,
            });
            (growth.backend, growth.adapter) = (stats.backend, stats.adapter);
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Ok(growth)
}

/// What the program is asked for.
fn words(method: &Method, strands: u32, backend: &str) -> Vec<String> {
    let [groom, size, frames] =
        [format!("builtin:long:{strands}:32"), format!("{}x{}", SIZE[0], SIZE[1]), FRAMES.to_string()];
    let fixed = ["--solver", "tressfx", "--no-shadows", "--backend", backend, "--size", &size, "--frames", &frames];
    let fixed = fixed.map(str::to_owned);
    [&[groom][..], &fixed, &method.words].concat()
}

/// Writes the file, the page and the plot.
pub(crate) fn write(growth: &Growth, docs: &Path) -> Result<()> {
    let store = |name: &str, text: &str| {
        let path = docs.join(name);
        fs::write(&path, text).with_context(|| path.display().to_string())
    };
    store("growth.json", &(serde_json::to_string_pretty(growth)? + "\n"))?;
    store("growth.svg", &growth_plot::svg(growth)?)?;
    store("growth.md", &page(growth))
}

fn page(growth: &Growth) -> String {
    let [width, height] = growth.size;
    let mut page = format!(
        "# How time grows with what is seen\n\n\
         Made by `cargo xtask accuracy --growth`, which also makes [growth.json](growth.json), with the time of each pass. \
         `builtin:long` at {width}x{height}, solver `tressfx`, no shadows, {} frames; milliseconds are the sums of the medians of the passes \
         from shading to composite, on {} ({}). Tiles make the fragments that are seen; lists without hidden hair make few others, and the rest make all.\n\n\
         ![Milliseconds against strands](growth.svg)\n\n\
         | method | strands | ms | fragments | dropped | MB |\n|---|---|---|---|---|---|\n",
        growth.frames, growth.adapter, growth.backend
    );
    for point in &growth.points {
        let Point { method, strands, fragments, dropped, bytes, .. } = point;
        let megabytes = *bytes as f64 * 1e-6;
        let _ =
            writeln!(page, "| {method} | {strands} | {:.3} | {fragments} | {dropped} | {megabytes:.1} |", point.ms());
    }
    page.push('\n');
    for method in growth.methods() {
        if let Some(times) = growth.eightfold(method) {
            let _ = writeln!(page, "* {method}: eight times as many strands as 16,384 take {times:.2} times as long.");
        }
    }
    page
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn growth() -> Growth {
        let point = |method: &str, strands, ms| Point {
            method: method.into(),
            strands,
            passes: vec![PassTime { label: "hair.render.fill".into(), ms }],
            fragments: 1000,
            dropped: 0,
            bytes: 2_000_000,
        };
        let points = vec![
            point("ppll-k8", 16_384, 0.5),
            point("ppll-k8", 131_072, 4.0),
            point("tiles", 16_384, 0.5),
            point("tiles", 131_072, 1.25),
        ];
        Growth { backend: "vulkan".into(), adapter: "a GPU".into(), size: SIZE, frames: FRAMES, points }
    }

    #[test]
    fn the_page_says_how_much_longer_eight_times_as_many_strands_take() {
        let page = page(&growth());
        assert!(page.contains("| tiles | 131072 | 1.250 | 1000 | 0 | 2.0 |"), "{page}");
        assert!(page.contains("* tiles: eight times as many strands as 16,384 take 2.50 times as long."), "{page}");
        let mut untimed = growth();
        untimed.points.iter_mut().for_each(|point| point.passes.clear());
        assert!(untimed.eightfold("tiles").is_none(), "nothing was timed");
    }

    #[test]
    fn each_method_is_asked_for_with_its_own_words() {
        let methods = method::named(method::methods(Extent::Full), &METHODS.map(str::to_owned)).unwrap();
        let asked: Vec<_> = methods.iter().map(|method| words(method, 4096, "vulkan").join(" ")).collect();
        let fixed = "builtin:long:4096:32 --solver tressfx --no-shadows --backend vulkan --size 1920x1080 --frames 240";
        assert_eq!(
            asked,
            [
                "--oit ppll --skip-hidden false --oit-k 8",
                "--oit ppll --skip-hidden true --oit-k 8",
                "--oit shortcut --oit-k 3",
                "--oit tiles"
            ]
            .map(|own| format!("{fixed} {own}"))
        );
    }

    #[test]
    fn it_survives_its_file() {
        let folder = std::env::temp_dir().join(format!("tressfx-growth-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        write(&growth(), &folder).unwrap();
        assert_eq!(Growth::read(&folder.join("growth.json")).unwrap(), growth());
        fs::remove_dir_all(folder).unwrap();
    }
}
