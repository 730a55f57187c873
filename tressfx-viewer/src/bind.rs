//! `tressfx bind`.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use tressfx_sim::body::Binding;

use crate::body::{character, size};
use crate::groom::Groom;
use crate::say::say;

#[derive(Debug, Args)]
pub(crate) struct Bind {
    /// A file, or `builtin:NAME[:STRANDS[:VERTICES]]`
    groom: String,
    /// The body, in its bind pose
    #[arg(value_name = "MESH.glb|gltf|tfxmesh|obj")]
    mesh: PathBuf,
    /// Fail if any root is further away than this, in the unit of the files
    #[arg(long, value_name = "DISTANCE")]
    within: Option<f64>,
}

/// Binds the roots of a groom to a mesh and says how far they were from it.
pub(crate) fn run(args: &Bind) -> Result<()> {
    let groom = Groom::load(std::slice::from_ref(&args.groom), Some(0))?;
    let character = character(&args.mesh)?;
    let (strands, size) = (&groom.sections[0], size(&character));
    let binding = Binding::of_guides(strands, &character.mesh, args.within.unwrap_or(f64::INFINITY))?;
    let report = &binding.report;
    let percent = |distance: f64| 100.0 * distance / size;
    let furthest = strands.order.get(report.furthest).copied().unwrap_or(0);
    say(format_args!("{} on {}", strands.name, character.mesh.name))?;
    say(format_args!("  roots       {}", report.roots))?;
    say(format_args!("  size        {size:.4}, the diagonal of the body"))?;
    say(format_args!("  median      {:.6} away, {:.4} % of the size", report.median, percent(report.median)))?;
    say(format_args!("  99 of 100   {:.6} away at most, {:.4} %", report.most, percent(report.most)))?;
    say(format_args!("  furthest    {:.6} away, {:.4} %: strand {furthest}", report.largest, percent(report.largest)))?;
    if report.degenerate > 0 {
        say(format_args!("  degenerate  {} triangles without an area, which nothing is bound to", report.degenerate))?;
    }
    Ok(())
}
