//! A graphics driver: found, or installed through the system's package manager.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::chore::run;

/// The software Vulkan of a system, and how it is installed there.
struct PackageManager {
    program: &'static str,
    /// Run first, so that the packages are found.
    refresh: &'static [&'static str],
    install: &'static [&'static str],
}

const PACKAGE_MANAGERS: [PackageManager; 4] = [
    PackageManager {
        program: "apt-get",
        refresh: &["update"],
        install: &["install", "--yes", "--no-install-recommends", "mesa-vulkan-drivers", "libvulkan1"],
    },
    PackageManager {
        program: "dnf",
        refresh: &[],
        install: &["install", "-y", "mesa-vulkan-drivers", "vulkan-loader"],
    },
    PackageManager {
        program: "pacman",
        refresh: &[],
        install: &["-Sy", "--noconfirm", "vulkan-swrast", "vulkan-icd-loader"],
    },
    PackageManager { program: "apk", refresh: &[], install: &["add", "mesa-vulkan-swrast", "vulkan-loader"] },
];

/// Makes sure that `tressfx adapters` finds one.
pub(crate) fn ensure(tressfx: &Path) -> Result<(), String> {
    if has_adapter(tressfx)? {
        return Ok(());
    }
    println!("No Vulkan driver was found: installing Mesa's software driver.");
    install()?;
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

fn install() -> Result<(), String> {
    let manager = PACKAGE_MANAGERS.iter().find(|manager| answers(manager.program)).ok_or(
        "no package manager that we know was found: install a Vulkan driver for your graphics card, or Mesa's lavapipe, \
         and run this command again",
    )?;
    let prefix: &[&str] = if is_root() { &[] } else { &["sudo"] };
    let lines: Vec<Vec<&str>> = [manager.refresh, manager.install]
        .into_iter()
        .filter(|words| !words.is_empty())
        .map(|words| [prefix, &[manager.program], words].concat())
        .collect();
    let typed: Vec<String> = lines.iter().map(|line| line.join(" ")).collect();
    let by_hand = || format!("please type\n    {}\nand run this command again", typed.join("\n    "));
    if !is_root() && !answers("sudo") {
        return Err(format!("installing it needs root: {}", by_hand()));
    }
    for line in &lines {
        println!("    {}", line.join(" "));
        run(Command::new(line[0]).args(&line[1..]).env("DEBIAN_FRONTEND", "noninteractive"))
            .map_err(|error| format!("{error}\nit could not be installed: {}", by_hand()))?;
    }
    Ok(())
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

fn answers(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}
