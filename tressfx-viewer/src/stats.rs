//! Figures about a run: `--stats`.

use std::path::Path;

use anyhow::{Context, Result};
use comfy_table::{Table, presets};
use serde::Serialize;
use tressfx_core::backend::Timing;

/// The whole file. The keys are stable.
#[derive(Debug, Serialize)]
pub(crate) struct Stats {
    pub(crate) groom: GroomStats,
    pub(crate) backend: &'static str,
    pub(crate) adapter: String,
    pub(crate) frames: u32,
    pub(crate) passes: Vec<PassStats>,
    pub(crate) sim: SimStats,
    pub(crate) render: RenderStats,
}

/// What was simulated.
#[derive(Debug, Serialize)]
pub(crate) struct GroomStats {
    /// Guides and follow strands.
    pub(crate) strands: u64,
    pub(crate) vertices: u64,
}

/// GPU time of the passes of one label, over all times that it ran.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct PassStats {
    pub(crate) label: &'static str,
    pub(crate) median_ms: f64,
    pub(crate) min_ms: f64,
    pub(crate) runs: usize,
}

/// How well lengths were kept, at the end of the run.
#[derive(Debug, Default, Serialize)]
pub(crate) struct SimStats {
    /// Of `|length / rest length - 1|` over all edges longer than 1e-6 of their strand.
    pub(crate) max_edge_error: f64,
    pub(crate) rms_edge_error: f64,
    /// Positions that are not finite, and strands that were reset because they had become so.
    pub(crate) non_finite: u64,
    /// How often the whole groom was put back into its rest pose.
    pub(crate) resets: u64,
}

/// What the last frame drew.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(crate) struct RenderStats {
    /// What drew it: `ppll`, `shortcut` or `tiles`.
    pub(crate) technique: &'static str,
    /// That hair made, dropped ones too.
    pub(crate) fragments: u64,
    /// What found no room: fragments, or references of tiles to segments.
    pub(crate) dropped: u64,
    /// Fragments that were to be in order, found no room, and were blended behind those that are.
    pub(crate) merged: u64,
    pub(crate) pixels_with_hair: u64,
    /// Of all buffers and textures.
    pub(crate) peak_gpu_bytes: u64,
    /// Of those, the ones in which the technique of `--oit` keeps fragments and pixels.
    pub(crate) oit_bytes: u64,
    /// Of the reference renderer, where it drew the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reference: Option<ReferenceStats>,
}

/// What the reference renderer took, and how exact its picture is.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct ReferenceStats {
    /// A pixel.
    pub(crate) samples: u32,
    pub(crate) seconds: f64,
    /// Estimates of the error of sampling in linear light, over all pixels; none of a single sample.
    pub(crate) rms_error: Option<f64>,
    pub(crate) max_error: Option<f64>,
}

impl Stats {
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self)?;
        std::fs::write(path, text + "\n").with_context(|| path.display().to_string())
    }
}

/// Collects the times of passes over many frames.
#[derive(Debug, Default)]
pub(crate) struct PassTimes {
    /// In the order in which the labels first ran.
    passes: Vec<PassCost>,
}

/// The times of one label, and what it cost otherwise when it ran last.
#[derive(Debug)]
struct PassCost {
    label: &'static str,
    milliseconds: Vec<f64>,
    bytes: u64,
    invocations: Option<u64>,
}

impl PassTimes {
    pub(crate) fn add(&mut self, timings: &[Timing]) {
        for timing in timings {
            let milliseconds = timing.nanoseconds * 1e-6;
            let &Timing { label, bytes, invocations, .. } = timing;
            match self.passes.iter_mut().find(|pass| pass.label == label) {
                Some(pass) => {
                    pass.milliseconds.push(milliseconds);
                    (pass.bytes, pass.invocations) = (bytes, invocations);
                }
                None => {
                    let milliseconds = vec![milliseconds];
                    self.passes.push(PassCost { label, milliseconds, bytes, invocations });
                }
            }
        }
    }

    pub(crate) fn summary(&self) -> Vec<PassStats> {
        let summarise = |pass: &PassCost| {
            let mut times = pass.milliseconds.clone();
            times.sort_by(f64::total_cmp);
            PassStats { label: pass.label, median_ms: times[times.len() / 2], min_ms: times[0], runs: times.len() }
        };
        self.passes.iter().map(summarise).collect()
    }
}

impl PassTimes {
    /// One row a label: `--profile`.
    pub(crate) fn table(&self) -> String {
        let mut table = Table::new();
        table.load_style(presets::ASCII_MARKDOWN);
        table.set_header(["pass", "runs", "median ms", "least ms", "invocations", "MB bound"]);
        for (pass, times) in self.passes.iter().zip(self.summary()) {
            table.add_row([
                pass.label.to_owned(),
                times.runs.to_string(),
                format!("{:.4}", times.median_ms),
                format!("{:.4}", times.min_ms),
                pass.invocations.map_or_else(|| String::from("-"), |count| count.to_string()),
                format!("{:.3}", pass.bytes as f64 * 1e-6),
            ]);
        }
        if self.passes.is_empty() { String::from("the device cannot time passes") } else { table.to_string() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_summed_up_by_label_in_the_order_of_the_frame() {
        let mut times = PassTimes::default();
        let timing =
            |label, milliseconds: f64| Timing { nanoseconds: milliseconds * 1e6, ..Timing::new(label, None, 0) };
        times.add(&[timing("b", 3.0), timing("a", 1.0)]);
        times.add(&[timing("b", 1.0), timing("b", 2.0)]);
        let expected = [
            PassStats { label: "b", median_ms: 2.0, min_ms: 1.0, runs: 3 },
            PassStats { label: "a", median_ms: 1.0, min_ms: 1.0, runs: 1 },
        ];
        assert_eq!(times.summary(), expected);
    }
}
