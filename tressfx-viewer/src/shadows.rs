//! How shadows are made: `--no-shadows` and what belongs to it.

use clap::Args;
use tressfx_render::ShadowDesc;

#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Shadows {
    /// Light every strand as if it were alone
    #[arg(long)]
    no_shadows: bool,
    /// Cells across what a light sees, each way; 192 by default
    #[arg(long, value_name = "N", conflicts_with = "no_shadows")]
    shadow_texels: Option<u32>,
    /// Cells along the way of a light; 48 by default
    #[arg(long, value_name = "N", conflicts_with = "no_shadows")]
    shadow_layers: Option<u32>,
    /// Cells of the sky along the longest side of the groom; 32 by default
    #[arg(long, value_name = "N", conflicts_with = "no_shadows")]
    shadow_cells: Option<u32>,
    /// Lights that have cells of their own; 3 by default. Others are taken from what arrives from everywhere
    #[arg(long, value_name = "N", conflicts_with = "no_shadows")]
    shadow_lights: Option<u32>,
    /// Strands of a section that are counted at most; 32768 by default
    #[arg(long, value_name = "N", conflicts_with = "no_shadows")]
    shadow_samples: Option<u32>,
}

impl Shadows {
    /// The shadows that were asked for; none where there are none. The renderer checks their ranges.
    pub(crate) fn desc(&self) -> Option<ShadowDesc> {
        let desc = ShadowDesc::default();
        let [texels, layers] = [self.shadow_texels.unwrap_or(desc.texels), self.shadow_layers.unwrap_or(desc.layers)];
        let desc = desc.texels(texels, layers).cells(self.shadow_cells.unwrap_or(desc.cells));
        let desc = desc.lights(self.shadow_lights.unwrap_or(desc.lights));
        (!self.no_shadows).then(|| desc.samples(self.shadow_samples.unwrap_or(desc.samples)))
    }
}
