//! The backend from outside, held to the suite: what its caps say no to is skipped, and says so.

#[path = "../my_backend/cpu.rs"]
mod cpu;

use cpu::CpuBackend;
use tressfx_conformance::suite::{Outcome, report};
use tressfx_core::error::Error;

tressfx_conformance::suite!(|| Ok::<_, Error>(CpuBackend::new()));

#[test]
fn all_that_moves_bytes_runs() {
    let report = report(|| Ok::<_, Error>(CpuBackend::new()));
    let contract = report.iter().filter(|(name, _)| name.starts_with("contract::"));
    let (passed, others): (Vec<_>, Vec<_>) = contract.partition(|(_, outcome)| *outcome == Outcome::Passed);
    assert!(others.is_empty(), "{others:?}");
    assert!(passed.len() >= 19, "{} cases are the contract's", passed.len());
}
