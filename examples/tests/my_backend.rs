//! The backend from outside, held to the suite: what its caps say no to is skipped, and says so.

#[path = "../my_backend/cpu.rs"]
mod cpu;

use cpu::CpuBackend;
use tressfx_conformance::suite::{CASES, Outcome, report};
use tressfx_core::backend::Backend;
use tressfx_core::error::{Error, Need};

tressfx_conformance::suite!(|| Ok::<_, Error>(CpuBackend::new()), lacks: [Compute, Raster]);

/// Cases that are skipped ask for passes, and all others pass: the whole of the contract without passes.
#[test]
fn all_that_asks_for_no_pass_is_held_to() {
    let mut passed = Vec::new();
    for (name, outcome) in report(|| Ok::<_, Error>(CpuBackend::new())) {
        match outcome {
            Outcome::Passed => passed.push(name),
            Outcome::Skipped(Need::Compute | Need::Raster) => {}
            other => panic!("{name}: {other}"),
        }
    }
    let passes = [Need::Compute, Need::Raster, Need::FragmentWrites];
    let without = |case: &&tressfx_conformance::suite::Case| !case.needs.iter().any(|need| passes.contains(need));
    let expected: Vec<_> = CASES.iter().filter(without).map(|case| case.name).collect();
    assert_eq!(passed, expected);
    for group in ["contract::", "stale::", "rules::"] {
        assert!(passed.iter().any(|name| name.starts_with(group)), "{group}");
    }
    let contract: Vec<_> = CASES.iter().filter(|case| case.name.starts_with("contract::")).collect();
    assert!(contract.iter().all(|case| passed.contains(&case.name)), "the contract's own group is whole");
}

#[test]
fn it_claims_no_passes() {
    let backend = CpuBackend::new();
    let caps = backend.caps();
    assert!(!caps.compute && !caps.raster && !caps.fragment_writes && !caps.timestamps && caps.read_back);
}
