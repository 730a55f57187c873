//! `hair.render.shadow_splat`.

use std::f64::consts::FRAC_PI_4;

use glam::DVec3;

use super::Strands;
use super::shadow::{Grid, ShadowCells, in_frame, samples, shrinks_by};
use crate::uniforms::ShadowUniform;

/// Radius of the largest ball of skin, in cells.
const MAX_SKIN: f64 = 3.0;

/// What the hair of a frame takes in each cell.
pub fn shadow_splat(shadow: &ShadowUniform, index: usize, bounds: [DVec3; 2], sections: &[Strands]) -> ShadowCells {
    let mut made = ShadowCells::new(shadow, index, bounds);
    for strands in sections {
        let counted = samples(shadow, strands);
        for strand in 0..counted {
            for vertex in 0..strands.uniform.lod.vertices - 1 {
                if strands.is_sound(strand, vertex) && strands.is_sound(strand, vertex + 1) {
                    segment(&mut made, shadow, strands, strand, vertex);
                }
            }
        }
        let has_skin = shadow.frames[index].has_skin == 1;
        let roots = if has_skin { strands.uniform.guides.min(counted) } else { 0 };
        for strand in (0..roots).filter(|&strand| strands.is_sound(strand, 0) && strands.is_sound(strand, 1)) {
            skin(&mut made, shadow, strands, strand, f64::from(roots));
        }
    }
    made
}

fn segment(made: &mut ShadowCells, shadow: &ShadowUniform, strands: &Strands, strand: u32, vertex: u32) {
    let frame = &shadow.frames[made.index];
    let of = &strands.uniform;
    let ends = [vertex, vertex + 1].map(|vertex| in_frame(frame, strands.point(strand, vertex)));
    let width = strands.full_radius(strand, vertex) + strands.full_radius(strand, vertex + 1);
    let stands_for = (f64::from(of.lod.strands - 1) + f64::from(of.lod.fade)) / f64::from(samples(shadow, strands));
    let taken = f64::from(of.shadow_alpha) * width * stands_for / shrinks_by(frame, 0.5 * (ends[0] + ends[1]));
    let way = ends[1] - ends[0];
    let covered = if made.is_sky() { FRAC_PI_4 * way.length() } else { way.truncate().length() };
    let Grid { cell, .. } = made.grid;
    let [start, end] = ends.map(|end| made.grid.place(end));
    let steps = (end - start).abs().max_element().ceil().clamp(1.0, 512.0);
    for step in 0..steps as u32 {
        let at = start.lerp(end, (f64::from(step) + 0.5) / steps);
        let index = made.grid.index(at.to_array());
        made.cells[index].depth += taken * covered / (cell.x * cell.y * steps);
    }
}

fn skin(made: &mut ShadowCells, shadow: &ShadowUniform, strands: &Strands, strand: u32, roots: f64) {
    let frame = &shadow.frames[made.index];
    let [root, next] = [0, 1].map(|vertex| strands.point(strand, vertex));
    let growth = (next - root).normalize_or_zero();
    let across = shrinks_by(frame, in_frame(frame, root));
    let unit = DVec3::new(across, across, 1.0) * made.grid.cell;
    let extent = DVec3::from_array(made.grid.size.map(f64::from)) * unit;
    let spacing = (2.0 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x) / roots).sqrt();
    let radius = spacing.clamp(unit.x, MAX_SKIN * unit.x);
    let middle = made.grid.place(in_frame(frame, root - growth * (radius + unit.x.max(unit.z)))).floor();
    let reach = (radius / unit).ceil().as_ivec3();
    let along = |reach: i32| -reach..=reach;
    let ball = along(reach.z).flat_map(|z| along(reach.y).flat_map(move |y| along(reach.x).map(move |x| (x, y, z))));
    for off in ball.map(|(x, y, z)| DVec3::new(x.into(), y.into(), z.into())) {
        if (off * unit).length_squared() <= radius * radius {
            let index = made.grid.index((middle + off).to_array());
            made.cells[index].is_skin = true;
        }
    }
}
