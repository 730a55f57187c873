//! Three minutes of stress at most, the same cases each time.

use tressfx_stress::case::SolverName;
use tressfx_stress::gpu::BackendName;
use tressfx_stress::kept::kept;
use tressfx_stress::run::{Run, Settings, State};

/// Cases of each solver.
const CASES: u64 = 12;

fn short(solver: SolverName) {
    let backends = vec![BackendName::Wgpu, BackendName::Vulkan];
    let state = State::new(Settings { seed: 2, solvers: vec![solver], backends });
    let mut run = match Run::new(state, None) {
        Ok(run) => run.as_they_are(),
        Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => {
            eprintln!("skipped: {error}");
            return;
        }
        Err(error) => panic!("{error}"),
    };
    run.cases(CASES).unwrap();
    let tally = &run.state.tallies[&solver];
    println!("{}: {tally:?}", solver.name());
    let open: Vec<u64> = kept().unwrap().into_iter().filter(|kept| kept.open.is_some()).map(|kept| kept.seed).collect();
    let news: Vec<_> = run.state.failures.iter().filter(|failure| !open.contains(&failure.seed)).collect();
    let said: Vec<_> = news.iter().map(ToString::to_string).collect();
    assert!(news.is_empty(), "{}", said.join("\n"));
    assert_eq!((tally.cases, tally.compared), (CASES, CASES / 4));
    assert!(tally.sub_steps > 1000 && tally.energy.cases > 0 && tally.rest_speed.cases > CASES / 4);
}

#[test]
fn direct_survives() {
    short(SolverName::Direct);
}

#[test]
fn tressfx_survives() {
    short(SolverName::Tressfx);
}
