//! The program `tressfx`, as a child process.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::UNIX_EPOCH;

use anyhow::{Context, Result, anyhow, bail};
use serde::Deserialize;

use crate::scene::Bounds;

/// Where it is, and which one it is.
#[derive(Clone, Debug)]
pub(crate) struct Program {
    path: PathBuf,
    /// Changes when it is built anew.
    pub(crate) stamp: String,
}

/// Of `tressfx info --json`.
#[derive(Deserialize)]
struct Info {
    bounds: InfoBounds,
}

#[derive(Deserialize)]
struct InfoBounds {
    min: [f64; 3],
    max: [f64; 3],
}

/// Of `tressfx compare --json`.
#[derive(Debug, Deserialize)]
pub(crate) struct Comparison {
    pub(crate) flip_mean: f64,
    pub(crate) psnr_db: Option<f64>,
    pub(crate) max_difference: u8,
}

/// Of `tressfx render --stats`.
#[derive(Debug, Deserialize)]
pub(crate) struct Stats {
    pub(crate) backend: String,
    pub(crate) adapter: String,
    pub(crate) frames: u32,
    pub(crate) passes: Vec<PassStats>,
    pub(crate) render: RenderStats,
}

#[derive(Debug, Deserialize)]
pub(crate) struct PassStats {
    pub(crate) label: String,
    /// Of the sums of the frames that have such a pass.
    pub(crate) median_ms: f64,
    /// How many have.
    pub(crate) frames: u32,
}

#[derive(Debug, Deserialize)]
pub(crate) struct RenderStats {
    pub(crate) fragments: u64,
    pub(crate) dropped: u64,
    pub(crate) oit_bytes: u64,
    pub(crate) shadow_bytes: u64,
}

impl Program {
    /// # Errors
    /// If there is no such file.
    pub(crate) fn new(path: &Path) -> Result<Self> {
        let about = std::fs::metadata(path).with_context(|| path.display().to_string())?;
        let changed = about.modified()?.duration_since(UNIX_EPOCH)?.as_nanos();
        Ok(Self { path: path.to_owned(), stamp: format!("{} bytes, {changed}", about.len()) })
    }

    /// Runs it to its end; what it says to stderr is part of the error.
    fn run(&self, words: &[String]) -> Result<Output> {
        let shown = || format!("{} {}", self.path.display(), words.join(" "));
        let output = Command::new(&self.path).args(words).output().with_context(shown)?;
        if !output.status.success() {
            bail!("{}: {}\n{}", shown(), output.status, String::from_utf8_lossy(&output.stderr));
        }
        Ok(output)
    }

    fn json<T: serde::de::DeserializeOwned>(&self, words: &[&str]) -> Result<T> {
        let words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        let output = self.run(&words)?;
        serde_json::from_slice(&output.stdout).with_context(|| format!("what `{}` says", words.join(" ")))
    }

    /// The box around a groom.
    pub(crate) fn bounds(&self, groom: &str) -> Result<Bounds> {
        let mut grooms: Vec<Info> = self.json(&["info", groom, "--json"])?;
        let InfoBounds { min, max } = grooms.pop().ok_or_else(|| anyhow!("{groom}: nothing is known of it"))?.bounds;
        Ok(Bounds { min, max })
    }

    /// Draws a picture; `words` come between `render` and `--out`.
    pub(crate) fn render(&self, words: &[String], out: &Path) -> Result<()> {
        let end = ["--out".to_owned(), out.to_string_lossy().into_owned()];
        self.run(&[&["render".to_owned()], words, &end].concat()).map(drop)
    }

    /// Draws a picture and brings the figures of the run.
    pub(crate) fn measure(&self, words: &[String], out: &Path) -> Result<Stats> {
        let stats = out.with_extension("stats.json");
        let more = ["--stats".to_owned(), stats.to_string_lossy().into_owned()];
        self.render(&[words, &more].concat(), out)?;
        let text = std::fs::read_to_string(&stats).with_context(|| stats.display().to_string())?;
        serde_json::from_str(&text).with_context(|| stats.display().to_string())
    }

    /// How far two pictures are apart.
    pub(crate) fn compare(&self, a: &Path, b: &Path) -> Result<Comparison> {
        self.json(&["compare", &a.to_string_lossy(), &b.to_string_lossy(), "--json"])
    }
}
