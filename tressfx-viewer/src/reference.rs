//! The picture of the reference renderer: `tressfx render --reference`.
//!
//! What it is given is what the techniques on the GPU are given, read back: positions, colours, and the opaque scene with its
//! depth. With `--reference-light given` these are the colours that a frame is drawn with: the difference of the two pictures is
//! what the technique makes of the visibility of strands, and nothing else. Else they are those in each light alone, and how
//! much of it arrives is traced.

use std::time::Instant;

use anyhow::Result;
use glam::{DVec3, Vec3};
use tressfx_core::pass::{PassList, Ticket};
use tressfx_render::SectionDraw;
use tressfx_truth::{Section, ShadowMethod, Truth};

use crate::cli::{ReferenceLight, Render};
use crate::picture::texels;
use crate::reference_light::Unshaded;
use crate::run::{Progress, Run};
use crate::say::say;
use crate::stats::ReferenceStats;
use crate::studio::Studio;

/// What comes back from the GPU.
struct Tickets {
    color: Ticket,
    depth: Ticket,
    counters: Ticket,
    positions: Vec<Ticket>,
    colors: Vec<Ticket>,
    thickness: Vec<Ticket>,
}

/// A section on the CPU.
struct Strands {
    positions: Vec<[f32; 4]>,
    colors: Vec<[f32; 4]>,
    thickness: Vec<f32>,
}

/// Draws the frame that was simulated last, and says how long it took and how exact it is. Gives its linear light, row by row.
pub(crate) fn picture(run: &mut Run, studio: &mut Studio, args: &Render) -> Result<Vec<Vec3>> {
    let mut list = PassList::new();
    let tickets = requests(&mut list, run, studio, args)?;
    run.submit(&list)?;
    studio.take_stock(run, tickets.counters)?;
    let scene: Vec<DVec3> = texels(&run.fetch(tickets.color)?).map(|texel| texel.as_dvec4().truncate()).collect();
    let depth: Vec<f32> = bytemuck::pod_collect_to_vec(&run.fetch(tickets.depth)?);
    let strands = strands(run, studio, &tickets)?;
    let light = match args.reference_light {
        ReferenceLight::Given => None,
        ReferenceLight::Traced | ReferenceLight::Nearest => Some(Unshaded::new(run, studio)?),
    };
    let shadows = match args.reference_light {
        ReferenceLight::Nearest => ShadowMethod::NearestFibre { spacing: args.fibre_spacing },
        ReferenceLight::Given | ReferenceLight::Traced => ShadowMethod::Traced,
    };
    let begun = Instant::now();
    let truth = truth(run, studio, &strands, &depth)?;
    let truth = match &light {
        None => truth,
        Some(light) => light.on(truth, studio, run.head(&args.scene), shadows)?,
    };
    let bar = Progress::new(0, "tile");
    let picture = truth.render(args.samples, &|progress| bar.advance_of(progress.tiles));
    drop(bar);
    let error = picture.error().map_or_else(String::new, |error| {
        format!("; error of sampling, estimated: {:.5} RMS, {:.3} at most", error.rms, error.max)
    });
    let stats = ReferenceStats {
        samples: args.samples.get(),
        shadow_rays: picture.shadow_rays(),
        seconds: begun.elapsed().as_secs_f64(),
        rms_error: picture.error().map(|error| error.rms),
        max_error: picture.error().map(|error| error.max),
    };
    let ReferenceStats { samples, shadow_rays, seconds, .. } = stats;
    say(format_args!("reference: {samples} samples a pixel, {shadow_rays} rays towards light, {seconds:.1} s{error}"))?;
    studio.drawn.reference = Some(stats);
    Ok(picture.over(&scene).into_iter().map(|pixel| pixel.as_vec3()).collect())
}

/// Records the scene, and behind its read-back the hair, for its colours.
fn requests(list: &mut PassList, run: &Run, studio: &mut Studio, args: &Render) -> Result<Tickets> {
    let lights = studio.draw_scene(list, run.head(&args.scene), run.sim.pose())?;
    let (color, depth) = (list.read_texture(studio.targets.color), list.read_texture(studio.targets.depth));
    let counters = studio.draw_hair(list, run.sim.pose(), &lights)?;
    let buffers = studio.buffers(run);
    let mut read = |buffer, bytes: u64, vertices: u32| list.read_buffer(buffer, 0, bytes * u64::from(vertices));
    let positions = buffers.iter().map(|of| read(of.positions, 16, of.shape.strand_vertices())).collect();
    let thickness = buffers.iter().map(|of| read(of.thickness, 4, of.shape.guide_vertices())).collect();
    Ok(Tickets { color, depth, counters, positions, colors: request_colors(list, run, studio), thickness })
}

/// Reads back the colours of all sections, as the list has just made them.
pub(crate) fn request_colors(list: &mut PassList, run: &Run, studio: &Studio) -> Vec<Ticket> {
    let sections = studio.sections.iter().zip(studio.buffers(run));
    let bytes = |vertices: u32| 8 * u64::from(vertices);
    sections
        .map(|((strands, _), buffers)| list.read_buffer(strands.colors(), 0, bytes(buffers.shape.strand_vertices())))
        .collect()
}

fn strands(run: &mut Run, studio: &Studio, tickets: &Tickets) -> Result<Vec<Strands>> {
    let mut sections = Vec::new();
    for (index, (&positions, &colors)) in tickets.positions.iter().zip(&tickets.colors).enumerate() {
        let (shaded, material) = &studio.sections[index];
        let thickness: Vec<f32> = bytemuck::pod_collect_to_vec(&run.fetch(tickets.thickness[index])?);
        let thickness = shaded.own_thickness(material).unwrap_or(thickness);
        let positions = bytemuck::pod_collect_to_vec(&run.fetch(positions)?);
        let colors = texels(&run.fetch(colors)?).map(|color| color.to_array()).collect();
        sections.push(Strands { positions, colors, thickness });
    }
    Ok(sections)
}

fn truth(run: &Run, studio: &Studio, strands: &[Strands], depth: &[f32]) -> Result<Truth> {
    let pose = run.sim.pose();
    let draws: Vec<_> =
        studio.sections.iter().map(|(shaded, material)| SectionDraw::new(shaded, material, pose)).collect();
    let copied = draws.iter().zip(strands);
    let copied: Vec<_> =
        copied.map(|(draw, of)| (draw.copied_positions(&of.positions), draw.copied(&of.colors))).collect();
    let sections = draws.iter().zip(strands).zip(&copied);
    let sections: Vec<_> = sections
        .map(|((draw, strands), (positions, colors))| {
            let uniform = draw.uniform();
            Section {
                shape: draw.drawn_shape(),
                pose,
                positions,
                colors,
                thickness: &strands.thickness,
                fibre_radius: uniform.fibre_radius,
                tip_width: uniform.tip_width,
            }
        })
        .collect();
    Ok(Truth::new(&studio.view, &sections, Some(depth))?)
}
