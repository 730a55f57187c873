//! Grooms that were named on the command line.

use anyhow::{Context, Result};
use glam::Vec3;
use tressfx_core::asset::{self, HairAsset};
use tressfx_core::builtin::Builtin;
use tressfx_core::mesh::Mesh;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{self, Bounds, StrandOptions, Strands};

const BUILTIN: &str = "builtin:";

/// A file, or `builtin:NAME[:STRANDS[:VERTICES]]`.
pub(crate) fn asset(name: &str) -> Result<HairAsset> {
    match builtin(name)? {
        Some(builtin) => Ok(builtin.asset()),
        None => Ok(asset::read(name)?),
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
    pub(crate) fn load(names: &[String], follows: Option<u32>) -> Result<Self> {
        let assets = names.iter().map(|name| asset(name)).collect::<Result<Vec<_>>>()?;
        let points = assets.iter().flat_map(|asset| asset.placed_points().into_owned());
        let metres_per_unit = Some(strands::metres_per_unit(&Bounds::of(points.map(Vec3::from))));
        let options = StrandOptions { follows, metres_per_unit, ..StrandOptions::default() };
        let sections = assets.iter().map(|asset| Strands::new(asset, &options)).collect::<Result<_, _>>()?;
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
