//! Whole pictures of hair, premultiplied, row by row from the top.

use glam::{DVec3, DVec4};

use super::{Fragment, Section, fill, resolve, shade};
use crate::gpu::Frame;

/// The picture with every fragment kept and put in order.
pub fn exact(frame: &Frame, sections: &[Section], scene: &dyn Fn([u32; 2]) -> f32) -> Vec<DVec4> {
    resolved(frame, sections, scene, usize::MAX)
}

/// The picture with the `k` nearest fragments of a pixel in order.
pub fn resolved(frame: &Frame, sections: &[Section], scene: &dyn Fn([u32; 2]) -> f32, k: usize) -> Vec<DVec4> {
    let mut lists = lists(frame, sections, scene);
    lists.iter_mut().map(|list| resolve(list, k)).collect()
}

/// The exact picture from `factor` x `factor` samples a pixel: what it converges to is the truth about which strand hides
/// which within a pixel. There is no scene behind the hair.
pub fn supersampled(frame: &Frame, sections: &[Section], factor: u32) -> Vec<DVec4> {
    let size = frame.size;
    let fine = Frame { size: size.map(|side| side * factor), focal: frame.focal * factor as f32, ..*frame };
    let nothing = |_| frame.depth_offset;
    let samples = exact(&fine, sections, &nothing);
    let mut picture = vec![DVec4::ZERO; (size[0] * size[1]) as usize];
    for (i, sample) in samples.iter().enumerate() {
        let (x, y) = (i as u32 % fine.size[0], i as u32 / fine.size[0]);
        picture[(y / factor * size[0] + x / factor) as usize] += *sample / f64::from(factor * factor);
    }
    picture
}

fn lists(frame: &Frame, sections: &[Section], scene: &dyn Fn([u32; 2]) -> f32) -> Vec<Vec<Fragment>> {
    let mut lists = vec![Vec::new(); (frame.size[0] * frame.size[1]) as usize];
    for section in sections {
        let of = &section.uniform;
        let vertices = (0..of.vertices).flat_map(|vertex| (0..of.strands).map(move |strand| (strand, vertex)));
        let finite = |color: DVec4| if color.is_finite() { color } else { DVec3::ZERO.extend(color.w) };
        let colors: Vec<DVec4> =
            vertices.map(|(strand, vertex)| finite(shade(frame, section, strand, vertex))).collect();
        fill(frame, section, &colors, scene, &mut |fragment| {
            lists[(fragment.pixel[1] * frame.size[0] + fragment.pixel[0]) as usize].push(fragment);
        });
    }
    lists
}
