//! The folder of real grooms and meshes, which are no part of the repository.

use std::io::Write;
use std::path::PathBuf;

/// The folder, from the environment variable TRESSFX_ASSETS; without it says that the test is skipped.
pub(crate) fn folder() -> Option<PathBuf> {
    let folder = std::env::var_os("TRESSFX_ASSETS").map(PathBuf::from);
    if folder.is_none() {
        // Straight to the stream: the harness hides what a passing test prints through the macros.
        let _ = writeln!(std::io::stderr(), "skipped: TRESSFX_ASSETS is not set");
    }
    folder
}
