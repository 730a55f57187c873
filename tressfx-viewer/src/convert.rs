//! `tressfx convert`.

use anyhow::{Result, anyhow};
use tressfx_asset::WriteFormat;
use tressfx_core::asset::HairAsset;
use tressfx_core::strands::{StrandOptions, Strands};

use crate::cli::Convert;
use crate::groom;

/// Reads one file and writes another; says what the new format cannot hold.
pub(crate) fn run(args: &Convert) -> Result<()> {
    let mut asset = groom::asset(&args.input)?;
    let format = WriteFormat::of_path(&args.output)
        .ok_or_else(|| anyhow!("{}: the ending chooses the format: .tfx or .txt", args.output.display()))?;
    let dropped = tressfx_asset::dropped_by(&asset, format);
    if !dropped.is_empty() {
        eprintln!("{}: this format has no place for {}", args.output.display(), dropped.join(", "));
    }
    if format == WriteFormat::TressFx4 && asset.uniform_count().is_none() {
        asset = resampled(&asset)?;
    }
    Ok(tressfx_asset::write(&args.output, &asset, Some(format))?)
}

/// All strands with the vertex count of the longest one, in the order of the file.
fn resampled(asset: &HairAsset) -> Result<HairAsset> {
    let options = StrandOptions { shuffle: false, follows: Some(0), ..StrandOptions::default() };
    let strands = Strands::new(asset, &options)?;
    eprintln!("{}: all strands are resampled to {} vertices, as this format asks for", asset.name, strands.vertices);
    Ok(strands.pose_asset(&strands.rest, false)?)
}
