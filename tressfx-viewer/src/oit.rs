//! How fragments of hair behind each other are sorted and blended: `--oit` and what belongs to it.

use std::ops::RangeInclusive;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use tressfx_render::{AutoDesc, Fill, K_RANGE, PLACES, PpllDesc, ShortCutDesc, Tail, Technique, TilesDesc};

#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Oit {
    /// How fragments of hair behind each other are sorted and blended
    #[arg(long, value_enum, default_value_t = OitName::Auto)]
    oit: OitName,
    /// The nearest fragments of a pixel that are sorted; without it, the default of the technique
    #[arg(long, value_name = "K")]
    oit_k: Option<u32>,
    /// With `--oit ppll` or `auto`: what is seen of the fragments behind the K nearest; `shaded` by default
    #[arg(long, value_enum)]
    oit_tail: Option<TailName>,
    /// With `--oit ppll` or `auto`: fragments of a pixel that take memory, the nearest; the others are merged. Without it, all
    #[arg(long, value_name = "N")]
    oit_cap: Option<u32>,
    /// With `--oit ppll` or `auto`: bytes that the lists may take, 16 a fragment, 20 with several places. Without it, 256 MiB
    #[arg(long, value_name = "BYTES")]
    oit_bytes: Option<u64>,
    /// With `--oit shortcut`: blend the nearest fragments in order, instead of taking their mean
    #[arg(long)]
    oit_ordered: bool,
    /// Without `--oit shortcut`: places in a pixel where light passes hair for itself, 1, 4, 16 or 64. With more the picture is nearer to the truth,
    /// and takes longer; 1 by default
    #[arg(long, value_name = "N")]
    places: Option<u32>,
    /// Whether hair is left out that other hair hides: less than a thousandth is seen of it. Without it, where hair is dense, with `--oit shortcut` nowhere
    #[arg(long, value_name = "BOOL")]
    skip_hidden: Option<bool>,
    /// What turns segments of strands into fragments; the picture is the same
    #[arg(long, value_enum, default_value_t = FillName::Compute)]
    fill: FillName,
    /// What lays hair over the picture. Without it, compute passes where a GPU can, unless depth and coverage are asked for too
    #[arg(long, value_enum)]
    pub(crate) composite: Option<CompositeName>,
}

/// What lays hair over the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CompositeName {
    /// Compute passes
    Compute,
    /// Fragment shaders
    Raster,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FillName {
    /// Compute passes
    Compute,
    /// Fragment shaders
    Raster,
}

impl FillName {
    fn fill(self) -> Fill {
        match self {
            Self::Compute => Fill::Compute,
            Self::Raster => Fill::Raster,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TailName {
    /// Their mean colour, and their opacity
    Shaded,
    /// The same, with the colours weighted by what is seen of them about: nearer to the truth where hair is dense
    Weighted,
    /// The colour of hair without light, and their opacity
    Unshaded,
    /// Nothing
    None,
}

impl TailName {
    fn tail(self) -> Tail {
        match self {
            Self::Shaded => Tail::Shaded,
            Self::Weighted => Tail::Weighted,
            Self::Unshaded => Tail::Unshaded,
            Self::None => Tail::None,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum OitName {
    /// A list of fragments for each pixel (K from 0 to 32, 8 by default)
    Ppll,
    /// Layers of the nearest fragments of each pixel, in little memory (K from 1 to 8, 3 by default)
    Shortcut,
    /// All fragments of each pixel in order, until nothing more is seen
    Tiles,
    /// `ppll`, and `tiles` where hair is dense, by what was measured; on a CPU always `ppll`
    Auto,
}

impl Oit {
    /// The technique that was asked for.
    pub(crate) fn technique(&self) -> Result<Technique> {
        if self.oit_ordered && self.oit != OitName::Shortcut {
            bail!("--oit-ordered belongs to --oit shortcut");
        }
        if self.places.is_some() && self.oit == OitName::Shortcut {
            bail!("--places belongs to --oit ppll, --oit tiles and --oit auto");
        }
        let of_lists =
            [("tail", self.oit_tail.is_some()), ("cap", self.oit_cap.is_some()), ("bytes", self.oit_bytes.is_some())];
        for (name, is_given) in of_lists {
            if is_given && !self.has_lists() {
                bail!("--oit-{name} belongs to --oit ppll and --oit auto");
            }
        }
        match self.oit {
            OitName::Ppll => Ok(self.lists()?.into()),
            OitName::Auto => Ok(AutoDesc::default().lists(self.lists()?).tiles(self.tiles()?).into()),
            OitName::Shortcut => {
                let desc = ShortCutDesc::default();
                let k = self.k(desc.k, &ShortCutDesc::K_RANGE)?;
                let skips_hidden = self.skip_hidden.unwrap_or(desc.skips_hidden);
                Ok(desc.k(k).ordered(self.oit_ordered).fill(self.fill.fill()).skips_hidden(skips_hidden).into())
            }
            OitName::Tiles if self.oit_k.is_some() => bail!("--oit-k belongs to --oit ppll and --oit shortcut"),
            OitName::Tiles => Ok(self.tiles()?.into()),
        }
    }

    fn has_lists(&self) -> bool {
        matches!(self.oit, OitName::Ppll | OitName::Auto)
    }

    fn lists(&self) -> Result<PpllDesc> {
        let tail = self.oit_tail.map_or(Tail::Shaded, TailName::tail);
        let desc = PpllDesc::default().tail(tail).cap(self.oit_cap).fill(self.fill.fill());
        let bytes = self.oit_bytes.unwrap_or(desc.max_node_bytes);
        Ok(desc
            .max_node_bytes(bytes)
            .k(self.k(desc.k, &K_RANGE)?)
            .places(self.places()?)
            .skips_hidden(self.skip_hidden))
    }

    fn tiles(&self) -> Result<TilesDesc> {
        Ok(TilesDesc::default().places(self.places()?).skips_hidden(self.skip_hidden))
    }

    fn places(&self) -> Result<u32> {
        let places = self.places.unwrap_or(1);
        if !PLACES.contains(&places) {
            bail!("--places {places}: it must be 1, 4, 16 or 64");
        }
        Ok(places)
    }

    fn k(&self, default: u32, range: &RangeInclusive<u32>) -> Result<u32> {
        let k = self.oit_k.unwrap_or(default);
        if !range.contains(&k) {
            bail!("--oit-k {k}: it must be from {} to {}", range.start(), range.end());
        }
        Ok(k)
    }
}
