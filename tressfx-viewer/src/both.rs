//! One run on each backend, and how far their pictures differ: `--backend both`.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use crate::cli::{BackendName, Compare, Render};
use crate::say::say;
use crate::{compare, render};

/// Renders with each backend into a file of its own, and compares the two.
pub(crate) fn run(args: &Render) -> Result<()> {
    if args.out.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("png")) {
        bail!("{}: two backends are compared by a .png of the last frame", args.out.display());
    }
    let backends = [(BackendName::Wgpu, "wgpu"), (BackendName::Vulkan, "vulkan")];
    for (backend, name) in backends {
        let mut one = args.clone();
        one.scene.backend = backend;
        // The layer watches only what is ours.
        one.scene.validate &= backend == BackendName::Vulkan;
        one.out = named(&args.out, name);
        one.depth_out = args.depth_out.as_deref().map(|path| named(path, name));
        one.coverage_out = args.coverage_out.as_deref().map(|path| named(path, name));
        one.velocity_out = args.velocity_out.as_deref().map(|path| named(path, name));
        one.linear_out = args.linear_out.as_deref().map(|path| named(path, name));
        one.deep_out = args.deep_out.as_deref().map(|path| named(path, name));
        one.scene.stats = args.scene.stats.as_deref().map(|path| named(path, name));
        one.scene.trace = args.scene.trace.as_deref().map(|path| named(path, name));
        if args.scene.profile {
            say(name)?;
        }
        render::run(&one)?;
    }
    let [a, b] = backends.map(|(_, name)| named(&args.out, name));
    compare::run(&Compare { a, b, json: false, heat_map: Some(named(&args.out, "difference")) })
}

/// `picture.png` becomes `picture.NAME.png`.
fn named(path: &Path, name: &str) -> PathBuf {
    let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()));
    path.with_extension(format!("{name}{ending}"))
}
