//! How much of the hair is drawn: `--lod` and what belongs to it.

use clap::Args;
use tressfx_render::LodDesc;

#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Lod {
    /// Draw fewer and wider strands, of fewer vertices, where a groom is small in the picture
    #[arg(long, conflicts_with = "reference")]
    lod: bool,
    /// Pixels that a fibre is wide where the groom is nearest: below, strands are left out; 0.25 by default
    #[arg(long, value_name = "PIXELS", requires = "lod", value_parser = pixels)]
    lod_width: Option<f32>,
    /// Pixels by which strands may be off where vertices are left out; 1/3 by default
    #[arg(long, value_name = "PIXELS", requires = "lod", value_parser = pixels)]
    lod_deviation: Option<f32>,
}

fn pixels(text: &str) -> Result<f32, String> {
    let pixels: f32 = text.parse().map_err(|_| "not a number of pixels")?;
    if (0.0..=100.0).contains(&pixels) { Ok(pixels) } else { Err("must be from 0 to 100 pixels".to_owned()) }
}

impl Lod {
    /// The level of detail that was asked for; none draws all of it.
    pub(crate) fn desc(&self) -> Option<LodDesc> {
        let desc = LodDesc::default();
        let desc = desc.width(self.lod_width.unwrap_or(desc.width));
        self.lod.then(|| desc.deviation(self.lod_deviation.unwrap_or(desc.deviation)))
    }
}
