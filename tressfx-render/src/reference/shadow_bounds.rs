//! `hair.render.shadow_bounds`.

use glam::DVec3;

use super::Strands;
use super::shadow::{in_frame, samples};
use crate::uniforms::ShadowUniform;

/// The box of the hair in a frame; none where there is none.
pub fn shadow_bounds(shadow: &ShadowUniform, index: usize, sections: &[Strands]) -> Option<[DVec3; 2]> {
    let vertices = sections.iter().flat_map(|strands| {
        let pairs = (0..samples(shadow, strands))
            .flat_map(|strand| (0..strands.uniform.lod.vertices).map(move |v| (strand, v)));
        let sound = pairs.filter(|&(strand, vertex)| strands.is_sound(strand, vertex));
        sound.map(|(strand, vertex)| in_frame(&shadow.frames[index], strands.point(strand, vertex)))
    });
    vertices.fold(None, |bounds, at| {
        let [low, high] = bounds.unwrap_or([at; 2]);
        Some([low.min(at), high.max(at)])
    })
}
