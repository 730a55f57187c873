//! How strands are made from an asset.

use super::StrandsError;
use crate::asset::{HairAsset, MAX_VERTICES, MIN_VERTICES};

/// The most follow strands that a guide may have.
pub const MAX_FOLLOWS: u32 = 256;

/// Metres around a guide in which follow strands are placed where nothing says otherwise: the width of a lock.
const FOLLOW_RADIUS: f32 = 0.006;

/// How strands are made from an asset.
#[derive(Clone, Debug, PartialEq)]
pub struct StrandOptions {
    /// Vertices of every strand, 2 to 256; `None` takes the most that a strand of the file has, within these limits.
    pub vertices: Option<u32>,
    /// Follow strands per guide, at most [`MAX_FOLLOWS`]; `None` takes the file's hint, or none.
    pub follows: Option<u32>,
    /// Radius in which follow strands are placed, in the unit of the file; `None` takes the file's hint, or 6 mm.
    pub follow_radius: Option<f32>,
    /// See [`super::Strands::tip_separation`].
    pub tip_separation: f32,
    /// Whether the guides are shuffled, so that a prefix of them is an even sample; else they stay as in the file.
    pub shuffle: bool,
    /// Of the shuffle and of the follow strands. The same seed gives the same strands, to the bit.
    pub seed: u64,
    /// Metres that a unit of the file stands for; `None` guesses it from the size of the groom.
    pub metres_per_unit: Option<f32>,
}

impl Default for StrandOptions {
    fn default() -> Self {
        Self {
            vertices: None,
            follows: None,
            follow_radius: None,
            tip_separation: 0.0,
            shuffle: true,
            seed: 0,
            metres_per_unit: None,
        }
    }
}

/// Options that were checked, with the hints of the file in place of those that were not given.
pub(super) struct Settings {
    pub(super) guides: u32,
    pub(super) vertices: u32,
    pub(super) follows: u32,
    follow_radius: Option<f32>,
}

impl Settings {
    pub(super) fn follow_radius(&self, metres_per_unit: f32) -> f32 {
        self.follow_radius.unwrap_or(FOLLOW_RADIUS / metres_per_unit)
    }
}

impl StrandOptions {
    pub(super) fn resolve(&self, asset: &HairAsset) -> Result<Settings, StrandsError> {
        let most = asset.counts.iter().copied().max().unwrap_or(MIN_VERTICES);
        let vertices = self.vertices.unwrap_or(most.clamp(MIN_VERTICES, MAX_VERTICES));
        let follows = self.follows.or(asset.follow_count).unwrap_or(0);
        let follow_radius = self.follow_radius.or(asset.follow_radius);
        let fits_radius = |radius: f32| radius.is_finite() && radius >= 0.0;
        let fits_metres = |metres: f32| metres.is_normal() && metres > 0.0;
        check(asset, "vertices", vertices, (MIN_VERTICES..=MAX_VERTICES).contains(&vertices), "from 2 to 256")?;
        check(asset, "follows", follows, follows <= MAX_FOLLOWS, "from 0 to 256")?;
        let radius = follow_radius.unwrap_or(0.0);
        check(asset, "follow_radius", radius, fits_radius(radius), "a length of 0 or more")?;
        check(asset, "tip_separation", self.tip_separation, self.tip_separation.is_finite(), "a finite number")?;
        let metres = self.metres_per_unit.unwrap_or(1.0);
        check(asset, "metres_per_unit", metres, fits_metres(metres), "above 0")?;
        let guides = guides(asset, vertices, follows)?;
        Ok(Settings { guides, vertices, follows, follow_radius })
    }
}

fn check(
    asset: &HairAsset,
    option: &'static str,
    value: impl ToString,
    fits: bool,
    expected: &'static str,
) -> Result<(), StrandsError> {
    if fits {
        return Ok(());
    }
    Err(StrandsError::Option { file: asset.name.clone(), option, value: value.to_string(), expected })
}

/// The number of guides, where all vertices of all strands can be counted in 32 bits.
fn guides(asset: &HairAsset, vertices: u32, follows: u32) -> Result<u32, StrandsError> {
    let strands = (asset.strand_count() as u64).saturating_mul(1 + u64::from(follows));
    match u32::try_from(strands.saturating_mul(vertices.into())) {
        Ok(_) => Ok(asset.strand_count() as u32),
        Err(_) => Err(StrandsError::TooMany { file: asset.name.clone(), strands, vertices }),
    }
}
