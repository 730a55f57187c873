//! Parameters from a TOML file: `--params`.

use std::path::Path;

use anyhow::{Context, Result, bail};
use serde::Deserialize;
use tressfx_core::shape::Capsule;
use tressfx_render::{Lights, Material};
use tressfx_sim::{ClockParams, InterpolationParams, SimParams, VolumeParams, Wind};

use crate::light_params::{self, LightParams, SkyParams};

/// The file. Whatever is left out has its default.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Params {
    /// How time is cut.
    pub(crate) clock: ClockParams,
    /// How the strands of all sections move.
    pub(crate) sim: SimParams,
    /// How they look.
    pub(crate) material: Material,
    /// How strands are made between guides, where `--interpolate` asks for them.
    pub(crate) interpolation: InterpolationParams,
    /// The wind; `--wind` overrides its velocity.
    pub(crate) wind: Option<Wind>,
    /// Hair against hair; none where it is left out.
    pub(crate) volume: Option<VolumeParams>,
    /// What hair collides with, beside what a built-in groom brings: in the space and the unit of the groom.
    pub(crate) capsule: Vec<Capsule>,
    /// The light from everywhere; with `light` in the place of that of the studio.
    sky: Option<SkyParams>,
    /// Single lights.
    light: Vec<LightParams>,
    /// What is different in single sections, in the order of the grooms.
    section: Vec<SectionParams>,
}

/// One section; what it names replaces the table of the same name whole.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct SectionParams {
    sim: Option<SimParams>,
    material: Option<Material>,
}

impl Params {
    /// Reads and checks a file; without one, the defaults.
    pub(crate) fn read(path: Option<&Path>, sections: usize) -> Result<Self> {
        let Some(path) = path else { return Ok(Self::default()) };
        let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Self::parse(&text, sections).with_context(|| path.display().to_string())
    }

    fn parse(text: &str, sections: usize) -> Result<Self> {
        let params: Self = toml::from_str(text)?;
        if params.section.len() > sections {
            bail!("{} tables `section` for {sections} grooms", params.section.len());
        }
        params.clock.validate()?;
        params.interpolation.validate()?;
        if let Some(index) = params.capsule.iter().position(|capsule| !capsule.is_sound()) {
            bail!("capsule {index}: a number is not finite, or a radius is negative");
        }
        if let Some(wind) = &params.wind {
            wind.validate()?;
        }
        if let Some(volume) = &params.volume {
            volume.validate()?;
        }
        params.lights()?;
        for section in 0..sections {
            params.sim(section).validate()?;
            params.material(section).validate()?;
        }
        Ok(params)
    }

    /// The light; none where the file says nothing of it.
    pub(crate) fn lights(&self) -> Result<Option<Lights>> {
        light_params::lights(self.sky.as_ref(), &self.light)
    }

    /// How the strands of a section move.
    pub(crate) fn sim(&self, section: usize) -> &SimParams {
        self.section.get(section).and_then(|section| section.sim.as_ref()).unwrap_or(&self.sim)
    }

    /// How they look.
    pub(crate) fn material(&self, section: usize) -> &Material {
        self.section.get(section).and_then(|section| section.material.as_ref()).unwrap_or(&self.material)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_replaces_what_it_names() {
        let text = "[sim]\ndamping = 0.5\n[[section]]\n[[section]]\nsim = { damping = 0.25 }\n";
        let params = Params::parse(text, 2).unwrap();
        assert_eq!([0, 1].map(|section| params.sim(section).damping), [0.5, 0.25]);
        assert_eq!(params.material(1), &Material::default());
    }

    #[test]
    fn the_documented_defaults_are_the_defaults() {
        let text = include_str!("../../docs/parameters.toml");
        assert_eq!(Params::parse(text, 1).unwrap(), Params::default());
        // What stands there as a comment must be right too.
        let all = text.replace("# tip_", "tip_").replace("# fibre_", "fibre_").replace("# fibre.", "fibre.");
        let tables = all.split("# [").skip(1).map(|table| format!("[{}", table.replace("\n# ", "\n")));
        for table in [all.split("# [").next().unwrap().to_owned()].into_iter().chain(tables) {
            Params::parse(&table, 1).unwrap_or_else(|error| panic!("{error:#}\n{table}"));
        }
    }

    #[test]
    fn what_is_unknown_or_out_of_range_is_refused_by_name() {
        let message = |text| format!("{:#}", Params::parse(text, 1).unwrap_err());
        assert!(message("[sim]\ndampling = 0.5").contains("dampling"));
        assert!(message("[sim]\ndamping = 5.0").contains("damping = 5 must be from 0 to 1"));
        assert!(message("[material]\nopacity = 2.0").contains("opacity is 2"));
        assert!(message("[volume]\ncells = 1000").contains("volume.cells = 1000 must be from 4 to 128"));
        assert!(message("[clock]\nsub_step = 0.0").contains("sub_step"));
        assert!(
            message("[[capsule]]\na = [0, 0, 0]\nb = [0, 1, 0]\nradius_a = -1\nradius_b = 1").contains("capsule 0")
        );
        assert!(message("[[section]]\n[[section]]").contains("2 tables `section` for 1 grooms"));
    }
}
