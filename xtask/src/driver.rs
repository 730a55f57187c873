//! A graphics driver: found, or installed.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::packages::install;

/// Makes sure that `tressfx adapters` finds one.
pub(crate) fn ensure(tressfx: &Path) -> Result<(), String> {
    if has_adapter(tressfx)? {
        return Ok(());
    }
    println!("No Vulkan driver was found: installing Mesa's software driver.");
    install(|manager| manager.driver)?;
    if has_adapter(tressfx)? {
        return Ok(());
    }
    Err(String::from("a software Vulkan was installed, but no adapter is found: run `vulkaninfo --summary` to see why"))
}

fn has_adapter(tressfx: &Path) -> Result<bool, String> {
    let status = Command::new(tressfx)
        .arg("adapters")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .map_err(|error| format!("{}: {error}", tressfx.display()))?;
    Ok(status.success())
}
