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

/// GPU time of the passes of one label. A frame may have several, which need not be equal: times are sums within a frame.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct PassStats {
    pub(crate) label: &'static str,
    /// Over the frames that have such a pass.
    pub(crate) median_ms: f64,
    pub(crate) min_ms: f64,
    /// Frames that have such a pass.
    pub(crate) frames: usize,
    /// In the mean of those.
    pub(crate) passes_per_frame: f64,
    /// Passes of all frames.
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
    /// Vertices of strands that were drawn.
    pub(crate) vertices: u64,
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
    /// Bytes in which shadows are made.
    pub(crate) shadow_bytes: u64,
    /// Of the reference renderer, where it drew the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) reference: Option<ReferenceStats>,
}

/// What the reference renderer took, and how exact its picture is.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct ReferenceStats {
    /// A pixel.
    pub(crate) samples: u32,
    /// Rays towards light, of the whole picture.
    pub(crate) shadow_rays: u64,
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
    /// Frames so far.
    frames: usize,
}

/// The times of one label, and what it cost otherwise when it ran last.
#[derive(Debug)]
struct PassCost {
    label: &'static str,
    /// Of each frame that has such a pass, the sum.
    milliseconds: Vec<f64>,
    /// The last of those frames.
    frame: usize,
    runs: usize,
    bytes: u64,
    invocations: Option<u64>,
}

impl PassCost {
    fn new(label: &'static str) -> Self {
        Self { label, milliseconds: Vec::new(), frame: 0, runs: 0, bytes: 0, invocations: None }
    }

    fn add(&mut self, frame: usize, timing: &Timing) {
        if self.frame != frame {
            self.milliseconds.push(0.0);
        }
        if let Some(sum) = self.milliseconds.last_mut() {
            *sum += timing.nanoseconds * 1e-6;
        }
        (self.frame, self.bytes, self.invocations) = (frame, timing.bytes, timing.invocations);
        self.runs += 1;
    }

    fn summary(&self) -> PassStats {
        let mut times = self.milliseconds.clone();
        times.sort_by(f64::total_cmp);
        let (frames, runs) = (times.len(), self.runs);
        let passes_per_frame = runs as f64 / frames as f64;
        PassStats { label: self.label, median_ms: times[frames / 2], min_ms: times[0], frames, passes_per_frame, runs }
    }
}

impl PassTimes {
    /// Adds the passes of a frame.
    pub(crate) fn add(&mut self, timings: &[Timing]) {
        self.frames += 1;
        for timing in timings {
            let known = self.passes.iter().position(|pass| pass.label == timing.label);
            let index = known.unwrap_or_else(|| {
                self.passes.push(PassCost::new(timing.label));
                self.passes.len() - 1
            });
            self.passes[index].add(self.frames, timing);
        }
    }

    pub(crate) fn summary(&self) -> Vec<PassStats> {
        self.passes.iter().map(PassCost::summary).collect()
    }
}

impl PassTimes {
    /// One row a label: `--profile`.
    pub(crate) fn table(&self) -> String {
        let mut table = Table::new();
        table.load_style(presets::ASCII_MARKDOWN);
        table.set_header(["pass", "frames", "passes a frame", "median ms", "least ms", "invocations", "MB bound"]);
        for (pass, times) in self.passes.iter().zip(self.summary()) {
            table.add_row([
                pass.label.to_owned(),
                times.frames.to_string(),
                format!("{:.1}", times.passes_per_frame),
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
    fn times_are_those_of_frames_by_label_in_the_order_of_the_first() {
        let mut times = PassTimes::default();
        let timing =
            |label, milliseconds: f64| Timing { nanoseconds: milliseconds * 1e6, ..Timing::new(label, None, 0) };
        times.add(&[timing("b", 3.0), timing("a", 1.0)]);
        // A short round and a long one: neither of them is the frame.
        times.add(&[timing("b", 0.5), timing("b", 8.0)]);
        times.add(&[]);
        times.add(&[timing("b", 0.25), timing("a", 2.0), timing("b", 4.0)]);
        let of = |label, [median_ms, min_ms]: [f64; 2], frames, runs| {
            let passes_per_frame = runs as f64 / frames as f64;
            PassStats { label, median_ms, min_ms, frames, passes_per_frame, runs }
        };
        assert_eq!(times.summary(), [of("b", [4.25, 3.0], 3, 5), of("a", [2.0, 1.0], 2, 2)]);
        let table = times.table();
        assert!(table.contains("passes a frame") && table.contains("| 1.7 "), "{table}");
    }
}
