//! `hair.sim.field_flood` in f64.

use glam::{DVec3, IVec3};

use super::field::{FieldGrid, Nearest, Triangle, nearest_on};

/// A pass of jump flooding (Rong, Tan 2006): each node looks at those `reach` nodes to any side, takes the triangle whose point there is nearest to itself, and
/// finds its nearest point.
pub fn field_flood(grid: &FieldGrid, triangles: &[Triangle], known: &[Nearest], reach: u32) -> Vec<Nearest> {
    let flooded = |index: usize| {
        let node = grid.node(index);
        let point = node.as_dvec3();
        let around = (0..27).filter_map(|side| {
            let side = IVec3::new(side % 3, side / 3 % 3, side / 9) - 1;
            let other = node.as_ivec3() + side * reach as i32;
            let is_in = other.cmpge(IVec3::ZERO).all() && other.cmplt(grid.nodes.as_ivec3()).all();
            is_in.then(|| known[grid.index(other.as_uvec3())]).flatten()
        });
        let apart = |nearest: &(DVec3, u32)| nearest.0.distance_squared(point);
        let best = around.min_by(|one, other| apart(one).total_cmp(&apart(other)).then(one.1.cmp(&other.1)));
        best.map(|(_, triangle)| (nearest_on(&triangles[triangle as usize], point), triangle))
    };
    (0..grid.count()).map(flooded).collect()
}
