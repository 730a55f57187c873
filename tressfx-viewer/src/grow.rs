//! `tressfx grow`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use glam::Vec3;
use image::{DynamicImage, ImageReader};
use tressfx_asset::WriteFormat;
use tressfx_asset::grow::{Amount, Direction, Growth, SurfaceMap, grow};

use crate::body::character;
use crate::cli::{share, vector};
use crate::say::say;

/// Maps are pictures over the texture coordinates of the body, as they are stored: black is 0, white is 1, nothing is decoded as sRGB.
#[derive(Debug, Args)]
pub(crate) struct Grow {
    /// The body, in its bind pose; lengths and densities are in its unit
    #[arg(value_name = "BODY.glb|gltf|tfxmesh|obj")]
    body: PathBuf,
    /// The .tfx file to write
    #[arg(long, value_name = "FILE.tfx")]
    out: PathBuf,
    #[command(flatten)]
    amount: AmountArgs,
    /// A grey picture: what share of the density there is from place to place
    #[arg(long, value_name = "MAP.png")]
    density_map: Option<PathBuf>,
    /// Length of a strand
    #[arg(long, value_name = "LENGTH")]
    length: f32,
    /// A grey picture: what share of the length there is from place to place; where it is black, no hair grows
    #[arg(long, value_name = "MAP.png")]
    length_map: Option<PathBuf>,
    /// By what share of it strands are shorter, by chance
    #[arg(long, default_value_t = 0.2, value_name = "0..1", value_parser = share)]
    variation: f32,
    /// Vertices of each strand
    #[arg(long, default_value_t = 8, value_name = "N")]
    vertices: u32,
    /// Where hair is combed to, along the skin; without it, it stands
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    comb: Option<Vec3>,
    /// A picture of where hair is combed to, middle grey for nowhere: red along the first texture coordinate, green along the second (down the
    /// picture), blue along the normal
    #[arg(long, value_name = "MAP.png", conflicts_with = "comb")]
    direction_map: Option<PathBuf>,
    /// How far hair lies down on its way to the tip: 1 is along the skin
    #[arg(long, default_value_t = 0.7, value_name = "0..1", value_parser = share)]
    lie: f32,
    /// By how much directions differ from strand to strand
    #[arg(long, default_value_t = 0.1, value_name = "0..1", value_parser = share)]
    noise: f32,
    /// By how much strands wander on their way to the tip
    #[arg(long, default_value_t = 0.0, value_name = "0..1", value_parser = share)]
    frizz: f32,
    /// Strands in the middle of clumps; 0 for no clumps
    #[arg(long, default_value_t = 0, value_name = "N")]
    clumps: u32,
    /// How near to the strand in the middle of their clump tips are drawn
    #[arg(long, default_value_t = 0.7, value_name = "0..1", value_parser = share, requires = "clumps")]
    clump: f32,
    /// Radius of curls at the tip of a strand of full length; 0 for no curls
    #[arg(long, default_value_t = 0.0, value_name = "RADIUS", requires = "curl_length")]
    curl_radius: f32,
    /// The way along a strand in which a curl turns once
    #[arg(long, value_name = "LENGTH", requires = "curl_radius")]
    curl_length: Option<f32>,
    /// Of everything that is by chance
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct AmountArgs {
    /// Strands in a square unit
    #[arg(long, value_name = "N")]
    density: Option<f64>,
    /// Strands on all of the body; a map of densities shares them out
    #[arg(long, value_name = "N")]
    guides: Option<u32>,
}

/// Grows hair and writes it.
pub(crate) fn run(args: &Grow) -> Result<()> {
    let character = character(&args.body)?;
    let asset = grow(&character.mesh, &growth(args)?)?;
    tressfx_asset::write(&args.out, &asset, Some(WriteFormat::TressFx4))?;
    say(format_args!("{} strands of {} vertices, in {}", asset.strand_count(), args.vertices, args.out.display()))?;
    Ok(())
}

fn growth(args: &Grow) -> Result<Growth> {
    let gray = |path: &Option<PathBuf>| path.as_deref().map(gray).transpose();
    let direction = match (&args.direction_map, args.comb) {
        (Some(path), _) => Direction::Map(colors(path)?),
        (None, Some(comb)) => Direction::Comb(comb),
        (None, None) => Direction::Normal,
    };
    let all = Growth::default();
    Ok(Growth {
        amount: match args.amount.guides {
            Some(count) => Amount::Count(count),
            None => Amount::Density(args.amount.density.unwrap_or_default()),
        },
        density_map: gray(&args.density_map)?,
        vertices: args.vertices,
        length: args.length,
        length_map: gray(&args.length_map)?,
        variation: args.variation,
        direction,
        lie: args.lie,
        noise: args.noise,
        frizz: args.frizz,
        clumps: args.clumps,
        clump: args.clump,
        curl_radius: args.curl_radius,
        curl_length: args.curl_length.unwrap_or(all.curl_length),
        seed: args.seed,
    })
}

/// A picture of any depth; of one in colours its brightness.
fn gray(path: &Path) -> Result<SurfaceMap> {
    let image = read(path)?.into_luma16();
    map(path, [image.width(), image.height()], 1, image.as_raw())
}

fn colors(path: &Path) -> Result<SurfaceMap> {
    let image = read(path)?.into_rgb16();
    map(path, [image.width(), image.height()], 3, image.as_raw())
}

/// The crate refuses what would take more than 512 MiB.
fn read(path: &Path) -> Result<DynamicImage> {
    let named = || path.display().to_string();
    let reader = ImageReader::open(path).with_context(named)?.with_guessed_format().with_context(named)?;
    reader.decode().with_context(named)
}

fn map(path: &Path, size: [u32; 2], channels: u32, parts: &[u16]) -> Result<SurfaceMap> {
    let texels = parts.iter().map(|&part| f32::from(part) / 65535.0).collect();
    SurfaceMap::new(size, channels, texels).with_context(|| path.display().to_string())
}
