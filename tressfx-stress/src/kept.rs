//! What fails is made smaller, and kept.

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use crate::case::{Case, Part, SolverName};
use crate::gpu::{BackendName, Gpu};
use crate::judge::judge;
use crate::verdict::{Failure, Trouble};

/// A case that failed once, and is tried in every test since it was mended.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Kept {
    /// What moves the strands.
    pub solver: SolverName,
    /// What ran the passes.
    pub backend: BackendName,
    /// Of the case.
    pub seed: u64,
    /// The part of the case that failed.
    pub part: Part,
    /// What was wrong with it.
    pub was: String,
    /// Why it still fails, where that is known and not mended yet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub open: Option<String>,
}

/// The cases that failed once: `kept.json` of this package.
///
/// # Errors
/// The file is not what it should be.
pub fn kept() -> Result<Vec<Kept>> {
    serde_json::from_str(include_str!("../kept.json")).context("kept.json")
}

/// Whether a part of a case fails in the same way.
fn fails(gpu: &mut Gpu, failure: &Failure, part: Part) -> Result<Option<Trouble>> {
    let verdict = judge(gpu, failure.seed, failure.solver, part)?;
    Ok(verdict.troubles.into_iter().find(|trouble| trouble.kind() == failure.trouble.kind()))
}

/// Leaves strands and frames out for as long as what is left fails in the same way: halves of the strands, then of the frames.
///
/// # Errors
/// The device cannot be opened any more.
pub fn minimised(gpu: &mut Gpu, mut failure: Failure) -> Result<Failure> {
    let Ok(case) = Case::new(failure.seed, failure.solver, failure.part) else { return Ok(failure) };
    let frames = case.script.frames.len() as u32;
    let mut part = Part { strands: case.strands.guides, frames, ..failure.part };
    failure.part = part;
    while part.strands > 1 {
        let half = part.strands.div_ceil(2);
        let halves =
            [Part { strands: half, ..part }, Part { first: part.first + half, strands: part.strands - half, ..part }];
        let Some((smaller, trouble)) = first_that_fails(gpu, &failure, &halves)? else { break };
        part = smaller;
        failure = Failure { part, trouble, ..failure };
    }
    while part.frames > 0 {
        let fewer = [Part { frames: part.frames / 2, ..part }, Part { frames: part.frames - 1, ..part }];
        let Some((smaller, trouble)) = first_that_fails(gpu, &failure, &fewer)? else { break };
        part = smaller;
        failure = Failure { part, trouble, ..failure };
    }
    Ok(failure)
}

fn first_that_fails(gpu: &mut Gpu, failure: &Failure, parts: &[Part]) -> Result<Option<(Part, Trouble)>> {
    for part in parts {
        if let Some(trouble) = fails(gpu, failure, *part)? {
            return Ok(Some((*part, trouble)));
        }
    }
    Ok(None)
}
