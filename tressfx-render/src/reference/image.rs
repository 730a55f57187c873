//! Whole pictures of hair, premultiplied, row by row from the top.

use glam::{DVec3, DVec4};
use tressfx_core::view::View;

use super::fill::fill_projected;
use super::projection::Projection;
use super::{
    Fragment, Strands, resolve, resolve_at_places, resolve_with_tail, shade, shortcut_colors, shortcut_depths,
    shortcut_resolve, xyz,
};
use crate::lights::Lights;
use crate::ppll::Tail;

/// The picture with every fragment kept and put in order.
pub fn exact(view: &View, lights: &Lights, strands: &[Strands], scene: &dyn Fn([u32; 2]) -> f32) -> Vec<DVec4> {
    resolved(view, lights, strands, scene, usize::MAX)
}

/// The picture with the `k` nearest fragments of a pixel in order.
pub fn resolved(
    view: &View,
    lights: &Lights,
    strands: &[Strands],
    scene: &dyn Fn([u32; 2]) -> f32,
    k: usize,
) -> Vec<DVec4> {
    resolved_at_places(view, lights, strands, scene, k, 1)
}

/// The same where light passes so many places of a pixel for themselves.
///
/// # Panics
/// If there are others than 1, 4, 16 or 64.
pub fn resolved_at_places(
    view: &View,
    lights: &Lights,
    strands: &[Strands],
    scene: &dyn Fn([u32; 2]) -> f32,
    k: usize,
    places: u32,
) -> Vec<DVec4> {
    let mut lists = lists(view, lights, strands, scene, 1);
    lists.iter_mut().map(|list| resolve_at_places(list, k, places)).collect()
}

/// The picture with the `k` nearest fragments of a pixel in order, and something else behind them.
pub fn resolved_with_tail(
    view: &View,
    lights: &Lights,
    strands: &[Strands],
    scene: &dyn Fn([u32; 2]) -> f32,
    k: usize,
    tail: Tail,
) -> Vec<DVec4> {
    let segments = |of: &Strands| f64::from(of.uniform.lod.strands * (of.uniform.lod.vertices - 1));
    let sum: DVec3 = strands.iter().map(|of| xyz(&of.uniform.base) * segments(of)).sum();
    let unlit = sum / strands.iter().map(segments).sum::<f64>();
    let mut lists = lists(view, lights, strands, scene, 1);
    lists.iter_mut().map(|list| resolve_with_tail(list, k, 1, tail, unlit)).collect()
}

/// The picture from the `k` nearest fragments of each pixel, in order or as their mean, with the opacity of all.
pub fn shortcut(
    view: &View,
    lights: &Lights,
    strands: &[Strands],
    scene: &dyn Fn([u32; 2]) -> f32,
    k: usize,
    ordered: bool,
) -> Vec<DVec4> {
    let of_pixel = |fragments: &Vec<Fragment>| {
        let layers = shortcut_depths(fragments, k);
        shortcut_resolve(&shortcut_colors(fragments, &layers, k), &layers, ordered)
    };
    lists(view, lights, strands, scene, 1).iter().map(of_pixel).collect()
}

/// The exact picture from `factor` x `factor` samples a pixel: what it converges to is the truth about which strand hides
/// which within a pixel. There is no scene behind the hair.
pub fn supersampled(view: &View, lights: &Lights, strands: &[Strands], factor: u32) -> Vec<DVec4> {
    let far = view.depth().far();
    let mut lists = lists(view, lights, strands, &|_| far, factor);
    let width = view.size()[0];
    let mut picture = vec![DVec4::ZERO; (width * view.size()[1]) as usize];
    for (i, list) in lists.iter_mut().enumerate() {
        let (x, y) = (i as u32 % (width * factor), i as u32 / (width * factor));
        picture[(y / factor * width + x / factor) as usize] += resolve(list, usize::MAX) / f64::from(factor * factor);
    }
    picture
}

fn lists(
    view: &View,
    lights: &Lights,
    strands: &[Strands],
    scene: &dyn Fn([u32; 2]) -> f32,
    factor: u32,
) -> Vec<Vec<Fragment>> {
    let projection = Projection::new(view).finer(factor);
    let size = projection.size;
    let mut lists = vec![Vec::new(); (size[0] * size[1]) as usize];
    for strands in strands {
        let of = &strands.uniform;
        let vertices = (0..of.vertices).flat_map(|vertex| (0..of.strands).map(move |strand| (strand, vertex)));
        let finite = |color: DVec4| if color.is_finite() { color } else { DVec3::ZERO.extend(color.w) };
        let colors: Vec<DVec4> =
            vertices.map(|(strand, vertex)| finite(shade(view, lights, strands, strand, vertex))).collect();
        fill_projected(&projection, strands, &colors, scene, &mut |fragment| {
            lists[(fragment.pixel[1] * size[0] + fragment.pixel[0]) as usize].push(fragment);
        });
    }
    lists
}
