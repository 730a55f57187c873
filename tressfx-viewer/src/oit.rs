//! How fragments of hair behind each other are sorted and blended: `--oit` and what belongs to it.

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use tressfx_render::{K_RANGE, PpllDesc, Technique};

#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Oit {
    /// How fragments of hair behind each other are sorted and blended
    #[arg(long, value_enum, default_value_t = OitName::Ppll)]
    oit: OitName,
    /// Fragments of a pixel that are sorted exactly; without it, the default of the technique
    #[arg(long, value_name = "K")]
    oit_k: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum OitName {
    /// A list of fragments for each pixel (K from 1 to 16, 8 by default)
    Ppll,
}

impl Oit {
    /// The technique that was asked for.
    pub(crate) fn technique(&self) -> Result<Technique> {
        match self.oit {
            OitName::Ppll => {
                let desc = PpllDesc::default();
                let k = self.oit_k.unwrap_or(desc.k);
                if !K_RANGE.contains(&k) {
                    bail!("--oit-k {k}: it must be from {} to {}", K_RANGE.start(), K_RANGE.end());
                }
                Ok(desc.k(k).into())
            }
        }
    }
}
