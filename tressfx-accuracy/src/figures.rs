//! What is measured, and the file that keeps it.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::{Context, Result, bail};
use serde::{Deserialize, Serialize};

use crate::change::Change;
use crate::method;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    Quick,
    Full,
    /// Shadows in place of techniques, at rest and shaken.
    Light,
}

impl Extent {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Full => "full",
            Self::Light => "light",
        }
    }

    pub(crate) fn setting(self) -> Setting {
        match self {
            Self::Quick => Setting { size: [320, 180], samples: 256, frames: 1, bits: 16 },
            Self::Full => Setting { size: [1280, 720], samples: 1024, frames: 60, bits: 16 },
            Self::Light => Setting { size: [320, 180], samples: 256, frames: 30, bits: 16 },
        }
    }
}

/// What has to be the same for figures to be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Setting {
    /// Pixels.
    pub(crate) size: [u32; 2],
    /// Rays a pixel of the reference renderer.
    pub(crate) samples: u32,
    /// Frames that are simulated and drawn; the last one is compared.
    pub(crate) frames: u32,
    /// Bits of a channel of the pictures that are compared.
    #[serde(default = "eight")]
    pub(crate) bits: u32,
}

/// What was compared before more were.
fn eight() -> u32 {
    8
}

/// GPU time of the passes of one label in a frame: the median over the runs of a pass, times its runs in a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PassTime {
    pub(crate) label: String,
    pub(crate) ms: f64,
}

/// Time of all these in milliseconds; none where the device cannot time passes.
pub(crate) fn sum_of(passes: &[PassTime]) -> Option<f64> {
    (!passes.is_empty()).then(|| passes.iter().map(|pass| pass.ms).sum())
}

/// One method on one scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Row {
    pub(crate) scene: String,
    pub(crate) method: String,
    pub(crate) backend: String,
    /// The device that the times were taken on.
    pub(crate) adapter: String,
    /// Mean of FLIP against the reference renderer.
    pub(crate) flip: f64,
    /// None for equal pictures.
    pub(crate) psnr_db: Option<f64>,
    /// Of any channel, in steps of 8 bits.
    pub(crate) largest: u8,
    /// Of the passes that draw hair.
    pub(crate) passes: Vec<PassTime>,
    pub(crate) fragments: u64,
    pub(crate) dropped: u64,
    /// Of the buffers in which the technique keeps fragments and pixels, or in which shadows are made.
    pub(crate) bytes: u64,
}

impl Row {
    /// Time of a frame's hair in milliseconds; none where the device cannot time passes.
    pub(crate) fn ms(&self) -> Option<f64> {
        sum_of(&self.passes)
    }

    /// Root of the mean square error, of 1.
    pub(crate) fn rms(&self) -> f64 {
        self.psnr_db.map_or(0.0, |decibels| 10f64.powf(-decibels / 20.0))
    }

    /// What drew it: the backend, and the name of the device without the version of its driver.
    pub(crate) fn device(&self) -> (&str, &str) {
        (&self.backend, self.adapter.split(" (").next().unwrap_or_default())
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
    /// How much films change, where shadows are judged.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) changes: Vec<Change>,
    /// What a reader has to know of rows that are older than others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) note: Option<String>,
}

impl Run {
    /// The scenes, in their order.
    pub(crate) fn scenes(&self) -> Vec<&str> {
        let mut scenes: Vec<&str> = self.rows.iter().map(|row| row.scene.as_str()).collect();
        scenes.dedup();
        scenes
    }

    /// Whether a newer run with this setting can be compared with it, or put beside it.
    pub(crate) fn check_setting(&self, newer: Setting) -> Result<()> {
        if self.setting != newer {
            bail!("what is stored was measured at another setting, {:?}, not {newer:?}", self.setting);
        }
        Ok(())
    }

    /// The same with the scenes of a newer run in the place of what it knows of them; those that it does not know come last.
    pub(crate) fn with(self, newer: Self) -> Result<Self> {
        self.check_setting(newer.setting)?;
        let stay = self.rows.iter().filter(|row| newer.of_scene(&row.scene).next().is_none());
        let [old, new]: [BTreeSet<_>; 2] =
            [stay.map(Row::device).collect(), newer.rows.iter().map(Row::device).collect()];
        if !old.is_empty() && old != new {
            bail!("the rows that stay were measured by {old:?}, these by {new:?}: their times cannot be compared");
        }
        let of = |run: &Self, scene: &str| run.of_scene(scene).cloned().collect::<Vec<Row>>();
        let known = self.scenes();
        let added = newer.scenes().into_iter().filter(|scene| !known.contains(scene));
        let rows = known.iter().copied().chain(added).flat_map(|scene| match of(&newer, scene) {
            rows if rows.is_empty() => of(&self, scene),
            rows => rows,
        });
        Ok(Self { rows: rows.collect(), ..self.clone() })
    }

    /// The same with the methods of a newer run in the place of what it knows of them, in the scenes of that run.
    pub(crate) fn with_methods(self, newer: Self) -> Result<Self> {
        let is_newer = |row: &Row| newer.of_scene(&row.scene).any(|other| other.method == row.method);
        let scenes = newer.scenes();
        let stay = self.rows.iter().filter(|row| scenes.contains(&row.scene.as_str()) && !is_newer(row)).cloned();
        let mut rows: Vec<Row> = stay.chain(newer.rows.iter().cloned()).collect();
        let place = |row: &Row| scenes.iter().position(|scene| *scene == row.scene);
        rows.sort_by_key(|row| (place(row), method::place(&row.method)));
        self.with(Self { rows, ..newer.clone() })
    }

    pub(crate) fn of_scene<'a>(&'a self, scene: &'a str) -> impl Iterator<Item = &'a Row> {
        self.rows.iter().filter(move |row| row.scene == scene)
    }
}

/// The whole file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Report {
    #[serde(skip_serializing_if = "Option::is_none")]
    quick: Option<Run>,
    #[serde(skip_serializing_if = "Option::is_none")]
    full: Option<Run>,
    #[serde(skip_serializing_if = "Option::is_none")]
    light: Option<Run>,
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
            Extent::Light => &mut self.light,
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn row(method: &str, flip: f64, ms: f64) -> Row {
        Row {
            scene: "curly-near".into(),
            method: method.into(),
            backend: "wgpu".into(),
            adapter: "a GPU".into(),
            flip,
            psnr_db: Some(40.0),
            largest: 30,
            passes: vec![PassTime { label: "hair.render.fill".into(), ms }],
            fragments: 1000,
            dropped: 0,
            bytes: 1 << 20,
        }
    }

    #[test]
    fn figures_survive_their_file() {
        let path = std::env::temp_dir().join(format!("tressfx-accuracy-{}.json", std::process::id()));
        let mut report = Report::read(&path).unwrap();
        assert_eq!(report, Report::default());
        let rows = vec![Row { psnr_db: None, ..row("tiles", 0.125, 0.5) }, row("ppll", 0.25, 0.75)];
        *report.run(Extent::Quick) =
            Some(Run { setting: Extent::Quick.setting(), rows, changes: Vec::new(), note: None });
        report.write(&path).unwrap();
        assert_eq!(Report::read(&path).unwrap(), report);
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn rows_of_scenes_that_were_not_measured_again_stay() {
        let of = |scenes: &[(&str, f64)]| {
            let row = |&(scene, flip): &(&str, f64)| Row { scene: scene.into(), ..row("tiles", flip, 0.5) };
            let note = Some("some are older".into());
            Run { setting: Extent::Full.setting(), rows: scenes.iter().map(row).collect(), changes: Vec::new(), note }
        };
        let stored = of(&[("a", 0.1), ("a", 0.2), ("b", 0.3), ("c", 0.4)]);
        let merged = stored.clone().with(of(&[("d", 0.7), ("b", 0.5), ("b", 0.6)])).unwrap();
        assert_eq!(merged, of(&[("a", 0.1), ("a", 0.2), ("b", 0.5), ("b", 0.6), ("c", 0.4), ("d", 0.7)]));
        let small = Run { setting: Extent::Quick.setting(), ..of(&[("b", 0.5)]) };
        assert!(stored.clone().with(small).unwrap_err().to_string().contains("another setting"));
        let drawn_by = |adapter: &str| {
            let mut run = of(&[("b", 0.5)]);
            run.rows[0].adapter = adapter.into();
            run
        };
        assert!(stored.clone().with(drawn_by("a GPU (of a newer driver)")).is_ok());
        assert!(stored.with(drawn_by("a CPU")).unwrap_err().to_string().contains("a CPU"));
    }

    #[test]
    fn rows_of_methods_that_were_not_measured_again_stay() {
        let of = |rows: &[(&str, &str, f64)]| {
            let row =
                |&(scene, method, flip): &(&str, &str, f64)| Row { scene: scene.into(), ..row(method, flip, 0.5) };
            let rows = rows.iter().map(row).collect();
            Run { setting: Extent::Full.setting(), rows, changes: Vec::new(), note: None }
        };
        let stored = of(&[("a", "ppll-k8", 0.1), ("a", "tiles", 0.2), ("b", "ppll-k8", 0.3), ("b", "tiles", 0.4)]);
        let newer = of(&[("a", "ppll-k2", 0.5), ("a", "tiles", 0.6)]);
        let merged = [("a", "ppll-k2", 0.5), ("a", "ppll-k8", 0.1), ("a", "tiles", 0.6)];
        let all = [&merged[..], &[("b", "ppll-k8", 0.3), ("b", "tiles", 0.4)]].concat();
        assert_eq!(stored.with_methods(newer).unwrap(), of(&all));
    }

    #[test]
    fn errors_and_times_of_a_row() {
        let row = row("ppll", 0.25, 0.75);
        assert!((row.rms() - 0.01).abs() < 1e-12 && row.ms() == Some(0.75));
        assert!(Row { psnr_db: None, ..row.clone() }.rms() == 0.0);
        assert!(Row { passes: Vec::new(), ..row }.ms().is_none());
    }
}
