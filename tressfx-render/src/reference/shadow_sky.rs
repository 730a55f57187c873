//! `hair.render.shadow_sky`.

use glam::{DVec4, IVec3};

use super::shadow::ShadowCells;

/// The optical depth of a cell with skin.
const SKIN_DEPTH: f64 = 6.0;

/// Lebedev's weights of the faces, edges and corners of a cube.
const WEIGHTS: [f64; 3] = [1.0 / 21.0, 4.0 / 105.0, 9.0 / 280.0];

/// What arrives in each cell from everywhere: from the direction `d` it is `w + (x, y, z) . d`.
pub fn shadow_sky(counted: &ShadowCells) -> Vec<DVec4> {
    let size = counted.grid.size[0] as i32;
    (0..size.pow(3)).map(|i| arriving(counted, IVec3::new(i % size, i / size % size, i / (size * size)))).collect()
}

/// Depth of a cell; none outside of the box.
fn depth(counted: &ShadowCells, at: IVec3) -> Option<f64> {
    let size = counted.grid.size[0] as i32;
    let inside = at.cmpge(IVec3::ZERO).all() && at.cmplt(IVec3::splat(size)).all();
    let cell = || counted.cells[((at.z * size + at.y) * size + at.x) as usize];
    inside.then(cell).map(|cell| cell.depth + if cell.is_skin { SKIN_DEPTH } else { 0.0 })
}

fn arriving(counted: &ShadowCells, at: IVec3) -> DVec4 {
    let around = || (0..27).map(|i| IVec3::new(i % 3, i / 3 % 3, i / 9) - 1);
    if around().all(|step| depth(counted, at + step).unwrap_or(0.0) == 0.0) {
        return DVec4::W;
    }
    around().filter(|&step| step != IVec3::ZERO).fold(DVec4::ZERO, |sum, step| {
        let stride = step.as_dvec3().length();
        let own = 0.5 * depth(counted, at).unwrap_or(0.0);
        let others = (1..).map_while(|count| depth(counted, at + count * step)).sum::<f64>();
        let share = WEIGHTS[step.abs().element_sum() as usize - 1] * (-stride * (own + others)).exp();
        sum + share * (3.0 * step.as_dvec3() / stride).extend(1.0)
    })
}
