//! Grooms that were named on the command line.

use anyhow::{Context, Result};
use glam::Vec3;
use tressfx_asset::builtin::Builtin;
use tressfx_asset::mesh::Mesh;
use tressfx_core::asset::{AssetFormat, HairAsset};
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{self, Bounds, StrandOptions, Strands};

const BUILTIN: &str = "builtin:";

/// A groom of fewer strands than this is filled up with follow strands.
const FULL: u32 = 12_000;
/// Though not with more than this for a guide.
const MOST_FOLLOWS: u32 = 64;

/// A file, or `builtin:NAME[:STRANDS[:VERTICES]]`.
pub(crate) fn asset(name: &str) -> Result<HairAsset> {
    match builtin(name)? {
        Some(builtin) => Ok(builtin.asset()),
        None => Ok(tressfx_asset::read(name)?),
    }
}

fn builtin(name: &str) -> Result<Option<Builtin>> {
    name.strip_prefix(BUILTIN).map(|rest| Builtin::parse(rest).with_context(|| name.to_owned())).transpose()
}

/// The sections of one groom, and what they grow on.
#[derive(Debug)]
pub(crate) struct Groom {
    pub(crate) sections: Vec<Strands>,
    /// What they collide with, in the space of the head.
    pub(crate) capsules: Vec<Capsule>,
    /// What they grow on, to be drawn.
    pub(crate) mesh: Option<Mesh>,
}

impl Groom {
    /// Reads grooms; `follows` overrides what the files say. The sections share one unit, found from the size of the whole.
    /// Files of few guides are filled up with follow strands, built-in grooms have as many strands as was asked for.
    pub(crate) fn load(names: &[String], follows: Option<u32>) -> Result<Self> {
        let assets = names.iter().map(|name| asset(name)).collect::<Result<Vec<_>>>()?;
        let points = assets.iter().flat_map(|asset| asset.placed_points().into_owned());
        let metres_per_unit = Some(strands::metres_per_unit(&Bounds::of(points.map(Vec3::from))));
        let guides = assets.iter().map(HairAsset::strand_count).sum::<usize>() as u32;
        let section = |asset: &HairAsset| {
            let follows = follows.unwrap_or_else(|| follows_of(asset, guides));
            let options = StrandOptions { follows: Some(follows), metres_per_unit, ..StrandOptions::default() };
            Strands::new(asset, &options)
        };
        let sections = assets.iter().map(section).collect::<Result<_, _>>()?;
        let mut groom = Self { sections, capsules: Vec::new(), mesh: None };
        for name in names {
            if let Some(builtin) = builtin(name)? {
                groom.grow_on(&builtin);
            }
        }
        Ok(groom)
    }

    /// Sections of one style share one head.
    fn grow_on(&mut self, builtin: &Builtin) {
        if self.mesh.is_none() {
            self.mesh = Some(builtin.mesh());
            self.capsules = builtin.capsules();
        }
    }

    /// The box around all sections at rest.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of(self.sections.iter().flat_map(|section| [section.bounds.min, section.bounds.max]))
    }

    /// Positions of the guides of all sections at rest.
    pub(crate) fn rest(&self) -> Vec<Vec3> {
        self.sections.iter().flat_map(|section| section.rest.iter().map(|vertex| vertex.truncate())).collect()
    }

    /// Guides and follow strands of all sections.
    pub(crate) fn strands(&self) -> u64 {
        self.sections.iter().map(|section| u64::from(section.strand_count())).sum()
    }

    /// Vertices of all strands.
    pub(crate) fn vertices(&self) -> u64 {
        self.sections.iter().map(|section| u64::from(section.strand_count()) * u64::from(section.vertices)).sum()
    }
}

/// Follow strands of each guide, where nobody asked for a number: what the file says, or more where the groom would be thin.
fn follows_of(asset: &HairAsset, guides: u32) -> u32 {
    let fill = match asset.format {
        AssetFormat::Builtin => 0,
        _ => (FULL / guides.max(1)).min(MOST_FOLLOWS),
    };
    asset.follow_count.unwrap_or(0).max(fill)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thin_files_are_filled_up_and_others_left_alone() {
        let of =
            |format, follow_count| HairAsset { follow_count, ..HairAsset::new("", format, Vec::new(), Vec::new()) };
        assert_eq!(follows_of(&of(AssetFormat::TressFx4, None), 2228), 5);
        assert_eq!(follows_of(&of(AssetFormat::TressFx4, None), 3), 64);
        assert_eq!(follows_of(&of(AssetFormat::Text, Some(9)), 2000), 9, "the file asks for more");
        assert_eq!(follows_of(&of(AssetFormat::TressFx3, Some(0)), 20_000), 0);
        assert_eq!(follows_of(&of(AssetFormat::Builtin, None), 10), 0);
    }

    #[test]
    fn sections_share_the_unit_of_the_whole() {
        let groom = Groom::load(&["builtin:fur:50:4".into(), "builtin:long:50:8".into()], None).unwrap();
        assert_eq!(groom.sections.iter().map(|section| section.metres_per_unit).collect::<Vec<_>>(), [1.0, 1.0]);
        assert_eq!((groom.strands(), groom.vertices()), (100, 600));
        assert!(!groom.capsules.is_empty() && groom.mesh.is_some());
    }
}
