//! The system's package manager.

use std::process::{Command, Stdio};

use crate::chore::run;

/// What we install, and how it is installed on a system.
pub(crate) struct PackageManager {
    program: &'static str,
    /// Run first, so that the packages are found.
    refresh: &'static [&'static str],
    install: &'static [&'static str],
    /// A software Vulkan.
    pub(crate) driver: &'static [&'static str],
    /// The validation layer of Vulkan.
    pub(crate) validation: &'static [&'static str],
    /// glslang and the tools of SPIR-V.
    pub(crate) compilers: &'static [&'static str],
}

const PACKAGE_MANAGERS: [PackageManager; 4] = [
    PackageManager {
        program: "apt-get",
        refresh: &["update"],
        install: &["install", "--yes", "--no-install-recommends"],
        driver: &["mesa-vulkan-drivers", "libvulkan1"],
        validation: &["vulkan-validationlayers"],
        compilers: &["glslang-tools", "spirv-tools"],
    },
    PackageManager {
        program: "dnf",
        refresh: &[],
        install: &["install", "-y"],
        driver: &["mesa-vulkan-drivers", "vulkan-loader"],
        validation: &["vulkan-validation-layers"],
        compilers: &["glslang", "spirv-tools"],
    },
    PackageManager {
        program: "pacman",
        refresh: &[],
        install: &["-Sy", "--noconfirm"],
        driver: &["vulkan-swrast", "vulkan-icd-loader"],
        validation: &["vulkan-validation-layers"],
        compilers: &["glslang", "spirv-tools"],
    },
    PackageManager {
        program: "apk",
        refresh: &[],
        install: &["add"],
        driver: &["mesa-vulkan-swrast", "vulkan-loader"],
        validation: &["vulkan-validation-layers"],
        compilers: &["glslang", "spirv-tools"],
    },
];

/// Installs packages, as root or through sudo, and says what it types.
pub(crate) fn install(packages: impl Fn(&PackageManager) -> &'static [&'static str]) -> Result<(), String> {
    let manager = PACKAGE_MANAGERS.iter().find(|manager| answers(manager.program)).ok_or_else(|| {
        let names = packages(&PACKAGE_MANAGERS[0]).join(" and ");
        format!(
            "no package manager that we know was found: install what Debian calls {names}, and run this command again"
        )
    })?;
    let prefix: &[&str] = if is_root() { &[] } else { &["sudo"] };
    let lines: Vec<Vec<&str>> = [manager.refresh.to_vec(), [manager.install, packages(manager)].concat()]
        .into_iter()
        .filter(|words| !words.is_empty())
        .map(|words| [prefix, &[manager.program], &words].concat())
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

/// Whether there is such a program.
pub(crate) fn answers(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}
