//! What is moved: strands with known answers, and grooms that are shaken and blown at.

use std::f64::consts::TAU;
use std::path::PathBuf;

use anyhow::{Context, Result};
use glam::{Quat, Vec3};
use tressfx_asset::builtin::Builtin;
use tressfx_conformance::sim::part_of;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::strands::{StrandOptions, Strands};
use tressfx_core::view::Pose;
use tressfx_sim::{SimParams, StepInput, Wind};

use crate::figures::Extent;
use crate::method::{bare, bending};

/// Length of the strands with known answers, m.
pub(crate) const LENGTH: f64 = 0.2;
/// Bending length of the chain, m.
pub(crate) const CHAIN_BENDING: f64 = 0.01;
/// Length of the cantilever over its bending length.
pub(crate) const CANTILEVER_RATIO: f64 = 2.0;
/// Frames a second of all that is compared. The longest sub-steps take two frames.
pub(crate) const FPS: u32 = 60;

/// How the head moves, and the air.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    Still,
    /// 2 g at 4 Hz, along x.
    Shake,
    /// 4 m/s, in gusts.
    Wind,
}

/// Where the strands come from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// Straight, from the origin along x.
    Line,
    Builtin(&'static str),
    File(PathBuf),
}

/// What the answer is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// Many rigid links, by the Runge-Kutta method.
    Links,
    /// The heavy elastica, at the end.
    Elastica,
    /// The f64 function of `direct` with short sub-steps.
    ShortSteps,
}

/// A case.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) name: &'static str,
    /// None where its folder is not known.
    pub(crate) source: Option<Source>,
    pub(crate) motion: Motion,
    pub(crate) answer: Answer,
    /// Frames that are simulated.
    pub(crate) frames: u32,
    /// Every second frame after this one is compared.
    pub(crate) after: u32,
    pub(crate) params: SimParams,
}

/// Names of grooms, and their files where they are no built-in ones.
const GROOMS: [(&str, &str); 4] = [
    ("long", ""),
    ("curly", ""),
    ("mohawk", "tressfx41_ratboy/Ratboy_mohawk.tfx"),
    ("sintel", "sintel_lite/GEO-sintel_hair_emit.002-sintel_hair.tfx"),
];

/// All cases; those of real grooms have no source unless TRESSFX_ASSETS names a folder.
pub(crate) fn cases(extent: Extent) -> Vec<Case> {
    let names: &[(&str, &str, Motion)] = match extent {
        Extent::Quick => &[
            ("long-wind", "long", Motion::Wind),
            ("curly-shake", "curly", Motion::Shake),
            ("mohawk-shake", "mohawk", Motion::Shake),
            ("sintel-wind", "sintel", Motion::Wind),
        ],
        Extent::Full => &[
            ("long-shake", "long", Motion::Shake),
            ("long-wind", "long", Motion::Wind),
            ("curly-shake", "curly", Motion::Shake),
            ("curly-wind", "curly", Motion::Wind),
            ("mohawk-shake", "mohawk", Motion::Shake),
            ("mohawk-wind", "mohawk", Motion::Wind),
            ("sintel-shake", "sintel", Motion::Shake),
            ("sintel-wind", "sintel", Motion::Wind),
        ],
    };
    let chain = Case {
        name: "chain",
        source: Some(Source::Line),
        motion: Motion::Still,
        answer: Answer::Links,
        frames: 18,
        after: 0,
        params: bare(CHAIN_BENDING as f32),
    };
    let cantilever = Case {
        name: "cantilever",
        answer: Answer::Elastica,
        frames: 240,
        after: 238,
        params: bending((LENGTH / CANTILEVER_RATIO) as f32),
        ..chain.clone()
    };
    let groom = |&(name, groom, motion): &(&'static str, &str, Motion)| Case {
        name,
        source: source(groom),
        motion,
        answer: Answer::ShortSteps,
        frames: 60,
        after: 0,
        params: SimParams::default(),
    };
    [chain, cantilever].into_iter().chain(names.iter().map(groom)).collect()
}

fn source(groom: &str) -> Option<Source> {
    let (name, file) = GROOMS.iter().find(|(name, _)| *name == groom).expect("a groom of the table");
    match *file {
        "" => Some(Source::Builtin(name)),
        file => std::env::var_os("TRESSFX_ASSETS").map(|folder| Source::File(PathBuf::from(folder).join(file))),
    }
}

impl Case {
    /// An even sample of so many strands, of so many vertices where they are given.
    pub(crate) fn strands(&self, count: u32, vertices: Option<u32>) -> Result<Strands> {
        let source = self.source.as_ref().context("a case without strands")?;
        let asset = match source {
            Source::Line => line(count, vertices.unwrap_or(32)),
            Source::Builtin(name) => {
                Builtin { strands: count, ..name.parse().map_err(|error| anyhow::anyhow!("{name}: {error}"))? }.asset()
            }
            Source::File(path) => tressfx_asset::read(path).with_context(|| path.display().to_string())?,
        };
        let options = StrandOptions { follows: Some(0), vertices, ..StrandOptions::default() };
        Ok(part_of(&asset, count, &options)?)
    }

    /// What a frame that ends at this time is given.
    pub(crate) fn input(&self, seconds: f64, dt: f64, metres_per_unit: f32) -> StepInput<'static> {
        let swing = TAU * 4.0;
        let aside = match self.motion {
            Motion::Shake => 2.0 * 9.81 / (swing * swing) * (1.0 - (swing * seconds).cos()),
            Motion::Still | Motion::Wind => 0.0,
        };
        let translation = Vec3::X * (aside / f64::from(metres_per_unit)) as f32;
        let input = StepInput::new(dt, Pose { rotation: Quat::IDENTITY, translation });
        match self.motion {
            Motion::Wind => input.with_wind(Wind::new(Vec3::new(4.0, 0.0, 0.0))),
            Motion::Still | Motion::Shake => input,
        }
    }
}

/// Straight strands along x, all alike, pinned at their first vertex.
fn line(count: u32, vertices: u32) -> HairAsset {
    let at = |i: u32| [(LENGTH * f64::from(i) / f64::from(vertices - 1)) as f32, 0.0, 0.0];
    let points = (0..count).flat_map(|_| (0..vertices).map(at)).collect();
    let masses = (0..count).flat_map(|_| (0..vertices).map(|i| if i == 0 { 0.0 } else { 1.0 })).collect();
    let asset = HairAsset::new("line", AssetFormat::Builtin, points, vec![vertices; count as usize]);
    HairAsset { inverse_mass: Some(masses), ..asset }
}
