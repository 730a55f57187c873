//! `hair.render.shadow_light`.

use glam::{DVec3, DVec4};

use super::shade::towards;
use super::shadow::{BY_SKY, Grid, OPEN, ShadowCells, in_frame};
use super::{Arriving, Strands, shadow_bounds, shadow_sky, shadow_splat, shadow_sum};
use crate::lights::{Lights, STORED_LIGHTS};
use crate::uniforms::ShadowUniform;

/// What the kernels before it have found.
#[derive(Debug)]
pub struct Shadows<'a> {
    shadow: &'a ShadowUniform,
    lights: &'a Lights,
    sky: Option<(Grid, Vec<DVec4>)>,
    /// By frame; the sky's and those without hair have none.
    sums: Vec<Option<(Grid, Vec<f64>)>>,
}

impl<'a> Shadows<'a> {
    /// Runs the kernels up to this one.
    pub fn new(shadow: &'a ShadowUniform, lights: &'a Lights, sections: &[Strands]) -> Self {
        let counted = |index: usize| -> Option<ShadowCells> {
            let bounds = shadow_bounds(shadow, index, sections)?;
            Some(shadow_splat(shadow, index, bounds, sections))
        };
        let with_sky = (shadow.first == 0).then(|| counted(0)).flatten();
        let sky = with_sky.map(|counted| (counted.grid, shadow_sky(&counted)));
        let sum = |index: usize| counted(index).map(|counted| (counted.grid, shadow_sum(&counted)));
        let sums = (0..shadow.end as usize).map(|index| if index == 0 { None } else { sum(index) }).collect();
        Self { shadow, lights, sky, sums }
    }
}

/// What arrives at a point of the sky and of the first lights.
pub fn shadow_light(shadows: &Shadows, point: DVec3) -> Arriving {
    let Shadows { shadow, lights, sky, .. } = shadows;
    let sky = sky.as_ref().map_or(DVec4::W, |(grid, cells)| sky_at(grid, cells, in_frame(&shadow.frames[0], point)));
    let share = |light: usize| match shadow.of_light[light / 4][light % 4] {
        OPEN => 1.0,
        BY_SKY => (sky.w + sky.truncate().dot(towards(&lights.lights[light], point).0)).clamp(0.0, 1.0),
        frame => light_at(shadows, frame as usize, point),
    };
    Arriving { sky, lights: std::array::from_fn::<f64, STORED_LIGHTS, _>(share) }
}

/// Between the middles of eight cells.
fn sky_at(grid: &Grid, cells: &[DVec4], at: DVec3) -> DVec4 {
    let at = grid.place(at) - 0.5;
    let (corner, share) = (at.floor(), at - at.floor());
    (0..8).fold(DVec4::ZERO, |sum, i| {
        let step = DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let weight = (step * share + (1.0 - step) * (1.0 - share)).element_product();
        sum + weight * cells[grid.index((corner + step).to_array())]
    })
}

/// Between the middles of four rows of cells.
fn light_at(shadows: &Shadows, frame: usize, point: DVec3) -> f64 {
    let Some((grid, sums)) = &shadows.sums[frame] else { return 1.0 };
    let at = grid.place(in_frame(&shadows.shadow.frames[frame], point));
    let (corner, share) = ((at - 0.5).floor(), at - 0.5 - (at - 0.5).floor());
    let layer = at.z.floor().clamp(0.0, f64::from(grid.size[2] - 1));
    let within = (at.z - layer).clamp(0.0, 1.0);
    let taken = (0..4).fold(0.0, |sum, i| {
        let [x, y] = [f64::from(i & 1), f64::from(i >> 1)];
        let weight = (x * share.x + (1.0 - x) * (1.0 - share.x)) * (y * share.y + (1.0 - y) * (1.0 - share.y));
        let up_to = |layer: f64| sums[grid.index([corner.x + x, corner.y + y, layer])];
        let before = if layer > 0.0 { up_to(layer - 1.0) } else { 0.0 };
        sum + weight * (before + within * (up_to(layer) - before))
    });
    (-taken).exp()
}
