//! The Vulkan validation layer: found, or installed.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::packages::install;

/// Makes sure that `tressfx --validate` works: raw Vulkan is tested under its eyes.
pub(crate) fn ensure(tressfx: &Path) -> Result<(), String> {
    if works(tressfx)? {
        return Ok(());
    }
    println!("There is no Vulkan validation layer: installing it to test raw Vulkan with.");
    install(|manager| manager.validation)?;
    if works(tressfx)? {
        return Ok(());
    }
    Err(String::from("the validation layer was installed, but `tressfx render --backend vulkan --validate` fails"))
}

/// Renders a frame of next to nothing.
fn works(tressfx: &Path) -> Result<bool, String> {
    let out = std::env::temp_dir().join("tressfx-validation.png");
    let status = Command::new(tressfx)
        .args([
            "render",
            "builtin:wavy:8:4",
            "--backend",
            "vulkan",
            "--validate",
            "--frames",
            "1",
            "--size",
            "16x16",
            "--out",
        ])
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .map_err(|error| format!("{}: {error}", tressfx.display()))?;
    let _ = std::fs::remove_file(out);
    Ok(status.success())
}
