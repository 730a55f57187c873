//! Light for the reference renderer: what the strands look like in each light alone, from the GPU, and what is opaque.

use anyhow::Result;
use glam::Vec3;
use tressfx_core::pass::PassList;
use tressfx_core::view::Pose;
use tressfx_render::{LightPlace, Lights, SectionDraw};
use tressfx_truth::{Illumination, Light, LitSection, OpaqueMesh, ShadowMethod, Truth};

use crate::picture::texels;
use crate::reference::request_colors;
use crate::run::Run;
use crate::studio::Studio;

/// Colours of all strands in light that nothing shades.
pub(crate) struct Unshaded {
    /// For each section and light, a vertex of every strand.
    lights: Vec<Vec<Vec<[f32; 3]>>>,
    /// For each section, under a sky that is white all around.
    sky: Vec<Vec<[f32; 3]>>,
}

impl Unshaded {
    /// Draws the newest frame once for each light, and once for the sky.
    pub(crate) fn new(run: &mut Run, studio: &mut Studio) -> Result<Self> {
        let mut lights = vec![Vec::new(); studio.sections.len()];
        for light in studio.lights.lights.clone() {
            let alone = Lights { lights: vec![light.casts(false)], ..Lights::default() };
            let colors = colors(run, studio, &alone)?;
            lights.iter_mut().zip(colors).for_each(|(section, colors)| section.push(colors));
        }
        let sky = colors(run, studio, &Lights { sky: Vec3::ONE, ground: Vec3::ONE, ..Lights::default() })?;
        Ok(Self { lights, sky })
    }

    /// The strands in the light of the studio, with the meshes on the head that is at `head`.
    pub(crate) fn on(&self, truth: Truth, studio: &Studio, head: Pose, shadows: ShadowMethod) -> Result<Truth> {
        let Lights { sky, ground, lights } = &studio.lights;
        let sources: Vec<Light> = lights.iter().map(source).collect();
        let colors = self.lights.iter().zip(&self.sky).zip(&studio.sections);
        let sections: Vec<_> = colors
            .map(|((lights, sky), (_, material))| LitSection {
                lights,
                sky,
                shadow_alpha: material.shadow_alpha,
                self_shadow: material.self_shadow,
            })
            .collect();
        let meshes = studio.opaque.iter();
        let meshes = meshes.map(|mesh| OpaqueMesh { positions: &mesh.positions, indices: &mesh.indices, pose: head });
        let meshes: Vec<_> = meshes.collect();
        let (sky, ground) = (*sky, *ground);
        let lights = &sources;
        Ok(truth.lit_by(&Illumination { lights, sky, ground, sections: &sections, meshes: &meshes, shadows })?)
    }
}

/// The colours of each section in some light.
fn colors(run: &mut Run, studio: &mut Studio, lights: &Lights) -> Result<Vec<Vec<[f32; 3]>>> {
    let mut list = PassList::new();
    studio.draw_unshaded(&mut list, lights, run.sim.pose())?;
    let tickets = request_colors(&mut list, run, studio);
    run.backend.run(&list)?;
    let pose = run.sim.pose();
    let section = |(ticket, (strands, material))| {
        let colors: Vec<_> = texels(&run.fetch(ticket)?).map(|color| color.truncate().to_array()).collect();
        Ok(SectionDraw::new(strands, material, pose).copied(&colors))
    };
    tickets
        .into_iter()
        .zip(studio.sections.iter().map(|(strands, material)| (strands, material)))
        .map(section)
        .collect()
}

/// From where a light comes, for its shadows.
fn source(light: &tressfx_render::Light) -> Light {
    match light.place {
        _ if !light.casts => Light::Shadowless,
        LightPlace::Directional { towards } => Light::Directional { towards },
        LightPlace::Point { position, .. } => Light::Point { position },
    }
}
