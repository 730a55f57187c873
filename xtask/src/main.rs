//! Chores of the workspace: `cargo xtask demo`, `cargo xtask test`, `cargo xtask docs`, `cargo xtask accuracy`,
//! `cargo xtask stress`.

mod chore;
mod compilers;
mod driver;
mod packages;
mod programs;
mod validation;

use std::process::ExitCode;

const USAGE: &str = "usage: cargo xtask demo | test | docs | accuracy [--check] [--quick | --light | --growth] [--scene NAME]... [--times [--method NAME]...] [--device wgpu|vulkan|both] [--fresh] [--program FILE]
       | accuracy --motion [--check] [--quick] [--device wgpu|vulkan] [--pages] [--known] [--plate]
       cargo xtask stress [--hours H] [--seed N] [--backend wgpu|vulkan|both] [--solver direct|tressfx|both] [--case SEED] [--fresh]

  demo   installs a software Vulkan where there is no driver, builds in release, simulates and renders
         the built-in grooms into out/demo, and says where the pictures are
  test   formatting, clippy, all tests, and the documentation, each without a warning; installs the validation
         layer of Vulkan and compilers of other shader languages where there are none
  docs   makes the pictures of README.md and docs/ anew
  accuracy
         measures the error of each technique against the reference renderer, and its time, into docs/accuracy; with --check it
         fails where an error has grown. With --quick it takes minutes. Real grooms are measured too if TRESSFX_ASSETS is set.
         With --light it judges shadows by light that is traced, into docs/accuracy/light.md; with --growth it measures
         how time grows with the number of strands, into docs/accuracy/growth.md.
         With --motion it does the same for the solvers, their sub-steps, rounds and vertices, into docs/accuracy/motion.md; with --known it makes
         the plots of docs/motion.md, with --plate that of docs/materials.md. --scene measures some scenes alone; the rows of others stay.
         With --times it takes run times alone anew, where pictures have stayed the same
  stress plays random and hostile cases for an hour, or as long as it is told, and counts what goes wrong, into docs/stress.md; a run
         that was stopped goes on. A few of these cases are part of `test`";

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let done = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["demo"] => chore::demo(),
        ["test"] => chore::test(),
        ["docs"] => chore::docs(),
        ["accuracy", ref words @ ..] => chore::accuracy(words),
        ["stress", ref words @ ..] => chore::stress(words),
        _ => Err(String::from(USAGE)),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
