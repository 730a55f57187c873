//! Compilers that the shaders are tested with: found, or installed.

use crate::packages::{answers, install};

/// What `tressfx-viewer/tests/shaders.rs` runs.
const PROGRAMS: [&str; 2] = ["glslangValidator", "spirv-val"];

/// Makes sure that they are there.
pub(crate) fn ensure() -> Result<(), String> {
    let missing = || PROGRAMS.into_iter().find(|program| !answers(program));
    let Some(program) = missing() else { return Ok(()) };
    println!("There is no {program}: installing compilers to test the shaders with.");
    install(|manager| manager.compilers)?;
    missing().map_or(Ok(()), |program| Err(format!("compilers were installed, but {program} is not found")))
}
