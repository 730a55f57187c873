//! What failed once and was mended does not fail again.

use tressfx_stress::gpu::Gpu;
use tressfx_stress::judge::judge;
use tressfx_stress::kept::kept;

#[test]
fn cases_that_failed_once_do_not_fail_again() {
    let mut failed = Vec::new();
    for case in kept().unwrap().into_iter().filter(|case| case.open.is_none()) {
        let mut gpu = match Gpu::open(case.backend) {
            Ok(gpu) => gpu,
            Err(error) if std::env::var_os("TRESSFX_NO_GPU").is_some() => {
                eprintln!("skipped: {error}");
                return;
            }
            Err(error) => panic!("{error}"),
        };
        let verdict = judge(&mut gpu, case.seed, case.solver, case.part).unwrap();
        for trouble in verdict.troubles {
            failed.push(format!("seed {}, {}: {trouble} (it was: {})", case.seed, case.solver.name(), case.was));
        }
    }
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
