//! What the engines are told on the command line.

use anyhow::{Context, Result, bail};
use tressfx_asset::builtin::Builtin;

/// `[--validate] [OUT.png [GROOM [FRAMES [WIDTHxHEIGHT]]]]`
#[derive(Clone, Debug, PartialEq)]
pub struct Args {
    /// Where the last frame goes.
    pub out: String,
    /// What grows.
    pub groom: Builtin,
    /// How many frames are drawn, 60 a second.
    pub frames: u32,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether the validation layer watches.
    pub validate: bool,
}

impl Args {
    /// Reads them; `out` is where the picture goes where nothing is said.
    ///
    /// # Errors
    /// Where a groom or a number makes no sense.
    pub fn read(words: impl Iterator<Item = String>, out: &str) -> Result<Self> {
        let (switches, words): (Vec<_>, Vec<_>) = words.partition(|word| word.starts_with("--"));
        if let Some(unknown) = switches.iter().find(|switch| *switch != "--validate") {
            bail!("{unknown}: there is only --validate");
        }
        let word = |place: usize, default: &str| words.get(place).cloned().unwrap_or_else(|| default.to_owned());
        let size = word(3, "960x540");
        let (width, height) = size.split_once('x').context("a size is WIDTHxHEIGHT")?;
        Ok(Self {
            out: word(0, out),
            groom: Builtin::parse(&word(1, "long"))?,
            frames: word(2, "45").parse()?,
            size: [width.parse()?, height.parse()?],
            validate: !switches.is_empty(),
        })
    }
}
