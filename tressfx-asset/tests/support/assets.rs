//! The folder of real grooms and meshes, which are no part of the repository.

use std::path::PathBuf;

/// The folder, from the environment variable TRESSFX_ASSETS.
pub(crate) fn folder() -> PathBuf {
    std::env::var_os("TRESSFX_ASSETS").map(PathBuf::from).expect("TRESSFX_ASSETS names the folder")
}
