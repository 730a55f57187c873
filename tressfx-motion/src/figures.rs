//! What is measured, and the file that keeps it.

use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    Quick,
    Full,
}

impl Extent {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Full => "full",
        }
    }

    pub(crate) fn setting(self) -> Setting {
        match self {
            Self::Quick => Setting { sample: 12, timed: 1024, reference_rate: 1920 },
            Self::Full => Setting { sample: 48, timed: 16_384, reference_rate: 3840 },
        }
    }
}

/// What has to be the same for figures to be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Setting {
    /// Strands of a groom that are compared with the reference.
    pub(crate) sample: u32,
    /// Strands that are timed; of a file at most as many as it has.
    pub(crate) timed: u32,
    /// Sub-steps a second of the reference of grooms.
    pub(crate) reference_rate: u32,
}

/// One method on one case. Distances are those of tips as shares of the length of their strands, root mean squares over strands and
/// times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) case: String,
    /// `direct` or `tressfx`.
    pub(crate) solver: String,
    /// Sub-steps a second.
    pub(crate) rate: u32,
    /// Rounds of Newton's method, or iterations.
    pub(crate) rounds: u32,
    pub(crate) vertices: u32,
    /// The device that the times were taken on.
    pub(crate) adapter: String,
    /// GPU time of 1/60 s of motion, ms; none where the device cannot time passes.
    pub(crate) ms: Option<f64>,
    /// Strands that were timed.
    pub(crate) timed: u32,
    /// The largest error of an edge's length, as a share of it.
    pub(crate) edges: f64,
    /// Distance to the reference.
    pub(crate) distance: f64,
    /// How far the reference is from that with sub-steps of twice the length; none where it is of another kind.
    pub(crate) reference: Option<f64>,
    /// What the energy has changed by after a second, as a share of what the fall sets free; less than 0 is lost.
    pub(crate) energy: Option<f64>,
    /// The larger distance of 30 and of 144 frames a second to 60.
    pub(crate) frame_rate: Option<f64>,
    /// Distance to the method with half of the sub-step.
    pub(crate) sub_step: Option<f64>,
    /// Distance to the method with the most vertices.
    pub(crate) resolution: Option<f64>,
    /// The most that a vertex moves in a frame at rest, as a share of its strand's length.
    pub(crate) jitter: Option<f64>,
}

impl Row {
    /// Such as `direct 120/s, 2 rounds, 32 vertices`.
    pub(crate) fn method(&self) -> String {
        format!("{} {}/s, {} rounds, {} vertices", self.solver, self.rate, self.rounds, self.vertices)
    }

    /// Whether the device is a CPU that plays a GPU.
    pub(crate) fn is_software(&self) -> bool {
        ["llvmpipe", "SwiftShader", "lavapipe"].iter().any(|name| self.adapter.contains(name))
    }
}

/// All rows that were measured together.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Run {
    pub(crate) setting: Setting,
    pub(crate) rows: Vec<Row>,
}

impl Run {
    /// The cases, in their order.
    pub(crate) fn cases(&self) -> Vec<&str> {
        let mut cases: Vec<&str> = self.rows.iter().map(|row| row.case.as_str()).collect();
        cases.dedup();
        cases
    }

    pub(crate) fn of_case<'a>(&'a self, case: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |row| row.case == case)
    }
}

/// The whole file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Report {
    #[serde(skip_serializing_if = "Option::is_none")]
    quick: Option<Run>,
    #[serde(skip_serializing_if = "Option::is_none")]
    full: Option<Run>,
}

impl Report {
    /// An empty one where there is no file.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        if !path.exists() {
            return Ok(Self::default());
        }
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        serde_json::from_str(&text).with_context(|| path.display().to_string())
    }

    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self)? + "\n";
        std::fs::write(path, text).with_context(|| path.display().to_string())
    }

    pub(crate) fn run(&mut self, extent: Extent) -> &mut Option<Run> {
        match extent {
            Extent::Quick => &mut self.quick,
            Extent::Full => &mut self.full,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn row(rate: u32, distance: f64, ms: f64) -> Row {
        Row {
            case: "curly-shake".into(),
            solver: "direct".into(),
            rate,
            rounds: 2,
            vertices: 64,
            adapter: "a GPU".into(),
            ms: Some(ms),
            timed: 1024,
            edges: 1e-6,
            distance,
            reference: Some(1e-4),
            energy: None,
            frame_rate: None,
            sub_step: None,
            resolution: None,
            jitter: Some(1e-7),
        }
    }

    #[test]
    fn figures_survive_their_file() {
        let path = std::env::temp_dir().join(format!("tressfx-motion-{}.json", std::process::id()));
        let mut report = Report::read(&path).unwrap();
        assert_eq!(report, Report::default());
        let rows = vec![row(120, 0.0625, 0.5), Row { ms: None, ..row(240, 0.03125, 1.0) }];
        *report.run(Extent::Quick) = Some(Run { setting: Extent::Quick.setting(), rows });
        report.write(&path).unwrap();
        assert_eq!(Report::read(&path).unwrap(), report);
        std::fs::remove_file(path).unwrap();
    }
}
