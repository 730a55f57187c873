//! The suite under test: a backend with a fault must fail where that is looked for, and the same backend without one nowhere.

use tressfx_backend_wgpu::WgpuBackend;
use tressfx_conformance::faulty::{Fault, Faulty};
use tressfx_conformance::suite::{CASES, Outcome, report};

mod support;

/// Holds that the cases of a group find a fault, and says which did.
fn assert_caught(fault: Fault, group: &str) {
    if support::gpu().is_none() {
        return;
    }
    let cases = CASES.iter().filter(|case| case.name.starts_with(group));
    let caught = cases.filter_map(|case| {
        match case.outcome(|| WgpuBackend::headless().map(|backend| Faulty::new(backend, fault))) {
            Outcome::Failed(why) => Some((case.name, why)),
            _ => None,
        }
    });
    let caught: Vec<_> = caught.collect();
    assert!(!caught.is_empty(), "{fault:?}: no case of {group} finds it");
    let (name, why) = &caught[0];
    println!("{fault:?}: {} cases, the first is {name}: {}", caught.len(), why.lines().next().unwrap_or_default());
}

macro_rules! caught {
    ($($name:ident: $fault:ident in $($group:literal)+;)*) => {
        $(#[test] fn $name() { $(assert_caught(Fault::$fault, concat!($group, "::"));)+ })*

        /// A fault that is not in the table does not compile.
        const _: fn(Fault) = |fault| match fault {
            Fault::None $(| Fault::$fault)* => (),
        };
    };
}

caught! {
    uploads_first: UploadsFirst in "contract" "hazards";
    reads_last: ReadsLast in "contract" "hazards";
    reads_again: ReadsAgain in "contract";
    clears_all: ClearsAll in "contract";
    clears_nothing: ClearsNothing in "contract";
    copies_from_the_start: CopiesFromTheStart in "contract";
    memory_never_freed: MemoryNeverFreed in "contract";
    stale_ids_live: StaleIdsLive in "stale";
    caps_boast: CapsBoast in "caps";
    timings_reversed: TimingsReversed in "caps";
    cached_by_label: CachedByLabel in "shaders";
    bindings_swapped: BindingsSwapped in "shaders";
    grid_flat: GridFlat in "shaders";
    instances_ignored: InstancesIgnored in "shaders";
    upside_down: UpsideDown in "shaders";
    passes_dropped: PassesDropped in "hazards";
    counts_ignored: CountsIgnored in "hazards";
    rows_padded: RowsPadded in "formats";
    red_is_blue: RedIsBlue in "formats";
    srgb_linear: SrgbLinear in "formats";
    over_replaces: OverReplaces in "state";
    targets_swapped: TargetsSwapped in "state";
    keep_clears: KeepClears in "state";
    clear_keeps: ClearKeeps in "state";
    depth_swapped: DepthSwapped in "depth";
    depth_forgotten: DepthForgotten in "depth";
}

#[test]
fn without_a_fault_every_case_passes() {
    if support::gpu().is_none() {
        return;
    }
    for (name, outcome) in report(|| WgpuBackend::headless().map(|backend| Faulty::new(backend, Fault::None))) {
        assert!(!matches!(outcome, Outcome::Failed(_)), "{name}: {outcome}");
    }
}
