//! `tressfx grow`.

use std::path::PathBuf;

use anyhow::Result;
use clap::Args;
use glam::Vec3;
use tressfx_asset::WriteFormat;
use tressfx_asset::grow::{Growth, grow};

use crate::body::character;
use crate::cli::{share, vector};
use crate::say::say;

#[derive(Debug, Args)]
pub(crate) struct Grow {
    /// The body, in its bind pose; lengths and densities are in its unit
    #[arg(value_name = "BODY.glb|gltf|tfxmesh|obj")]
    body: PathBuf,
    /// The .tfx file to write
    #[arg(long, value_name = "FILE.tfx")]
    out: PathBuf,
    /// Strands in a square unit
    #[arg(long, value_name = "N")]
    density: f64,
    /// Length of a strand
    #[arg(long, value_name = "LENGTH")]
    length: f32,
    /// By what share of it strands are shorter, by chance
    #[arg(long, default_value_t = 0.2, value_name = "0..1", value_parser = share)]
    variation: f32,
    /// Vertices of each strand
    #[arg(long, default_value_t = 8, value_name = "N")]
    vertices: u32,
    /// Where hair is combed to, along the skin; without it, it stands
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    comb: Option<Vec3>,
    /// How far hair lies down on its way to the tip: 1 is along the skin
    #[arg(long, default_value_t = 0.7, value_name = "0..1", value_parser = share)]
    lie: f32,
    /// By how much directions differ from strand to strand
    #[arg(long, default_value_t = 0.1, value_name = "0..1", value_parser = share)]
    noise: f32,
    /// Of everything that is by chance
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

/// Grows hair and writes it.
pub(crate) fn run(args: &Grow) -> Result<()> {
    let character = character(&args.body)?;
    let growth = Growth {
        density: args.density,
        vertices: args.vertices,
        length: args.length,
        variation: args.variation,
        comb: args.comb.unwrap_or(Vec3::ZERO),
        lie: if args.comb.is_some() { args.lie } else { 0.0 },
        noise: args.noise,
        seed: args.seed,
    };
    let asset = grow(&character.mesh, &growth)?;
    tressfx_asset::write(&args.out, &asset, Some(WriteFormat::TressFx4))?;
    say(format_args!("{} strands of {} vertices, in {}", asset.strand_count(), args.vertices, args.out.display()))?;
    Ok(())
}
