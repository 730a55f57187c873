//! Grooms that were named on the command line.

use anyhow::{Context, Result, bail};
use tressfx_core::asset::{self, HairAsset};
use tressfx_core::builtin::Builtin;
use tressfx_core::mesh::Mesh;
use tressfx_core::shape::Capsule;
use tressfx_core::strands::{Bounds, StrandOptions, Strands};

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
    /// Reads grooms; `follows` overrides what the files say.
    pub(crate) fn load(names: &[String], follows: Option<u32>) -> Result<Self> {
        let mut groom = Self { sections: Vec::new(), capsules: Vec::new(), mesh: None };
        let options = StrandOptions { follows, ..StrandOptions::default() };
        for name in names {
            groom.sections.push(Strands::new(&asset(name)?, &options)?);
            if let Some(builtin) = builtin(name)? {
                groom.grow_on(&builtin);
            }
        }
        let unit = groom.metres_per_unit();
        if let Some(other) = groom.sections.iter().find(|section| section.metres_per_unit != unit) {
            bail!(
                "{} is in units of {unit} m and {} in units of {} m: the sections of a groom share one unit",
                groom.sections[0].name,
                other.name,
                other.metres_per_unit
            );
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

    pub(crate) fn metres_per_unit(&self) -> f32 {
        self.sections[0].metres_per_unit
    }

    /// The box around all sections at rest.
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::of(self.sections.iter().flat_map(|section| [section.bounds.min, section.bounds.max]))
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
