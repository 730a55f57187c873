//! Strands between guides: `--interpolate`.

use anyhow::Result;
use tressfx_core::backend::Backend;
use tressfx_core::pass::PassList;
use tressfx_core::strands::Strands;
use tressfx_render::{OwnLook, SectionDraw, StrandInfo};
use tressfx_sim::{HairSim, Interpolation, InterpolationParams};

use crate::cli::{Render, Scene};
use crate::groom::Groom;
use crate::own_look::Textures;

/// The scene of a picture: where strands are made between guides, none follows one.
pub(crate) fn scene(args: &Render) -> Scene {
    let follow = args.interpolate.map_or(args.scene.follow, |_| Some(0));
    Scene { follow, ..args.scene.clone() }
}

/// So many strands between the guides of all sections, each with as large a part of them as it has of the guides.
pub(crate) fn between(
    count: u32,
    (backend, list): (&mut dyn Backend, &mut PassList),
    (groom, sim): (&Groom, &HairSim),
    params: &InterpolationParams,
) -> Result<Vec<Interpolation>> {
    let guides: u64 = groom.sections.iter().map(|section| u64::from(section.guides)).sum();
    let sections = groom.sections.iter().zip(sim.buffers());
    let of_section = |(strands, buffers): (&Strands, _)| {
        let share = u64::from(count) * u64::from(strands.guides) / guides.max(1);
        Ok(Interpolation::new(backend, list, (buffers, strands), (share as u32).max(1), params)?)
    };
    sections.map(of_section).collect()
}

/// What a renderer wants to know of the strands, and what they bring along from their guides.
pub(crate) fn look(
    interpolation: &Interpolation,
    guides: &Strands,
    textures: &Textures,
) -> Result<(StrandInfo, OwnLook)> {
    let count = interpolation.buffers().shape.guides;
    let info = StrandInfo::between(guides, &interpolation.sample(guides)?, count);
    let brings_none = guides.vertex_colors.is_none() && guides.vertex_widths.is_none() && textures.are_none();
    let look = if brings_none { OwnLook::default() } else { textures.look(&interpolation.rest(guides, count)?)? };
    Ok((info, look))
}

/// Records the strands that frames read.
pub(crate) fn record(interpolations: &[Interpolation], list: &mut PassList, draws: &[SectionDraw]) {
    interpolations.iter().zip(draws).for_each(|(strands, draw)| strands.record(list, draw.needed_strands()));
}
