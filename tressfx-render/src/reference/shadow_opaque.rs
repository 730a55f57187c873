//! `hair.render.shadow_opaque`.

use glam::{DVec2, DVec3};

use super::matrix;
use crate::uniforms::{LensUniform, OpaqueUniform};

/// The share of a light that the opaque scene leaves at a point: `depth` is what the light sees, row by row.
pub fn shadow_opaque(scene: &OpaqueUniform, depth: &[f32], point: DVec3) -> f64 {
    let lens = &scene.lens;
    let at = matrix(&lens.to_eye).transform_point3(point);
    let distance = -at.z;
    let size = DVec2::new(scene.size[0].into(), scene.size[1].into());
    let pixel = on_screen(lens, at);
    if distance <= f64::from(lens.near) || pixel.cmplt(DVec2::ZERO).any() || pixel.cmpgt(size).any() {
        return 1.0;
    }
    let (corner, share) = ((pixel - 0.5).floor() - 1.0, (pixel - 0.5).fract());
    let weight = |step: f64, share: f64| {
        if step == 0.0 {
            1.0 - share
        } else if step == 3.0 {
            share
        } else {
            1.0
        }
    };
    let lit = |x: f64, y: f64| {
        let inside = (corner + DVec2::new(x, y)).clamp(DVec2::ZERO, size - 1.0);
        let seen = scene_at(lens, depth[inside.y as usize * scene.size[0] as usize + inside.x as usize]);
        let is_lit = distance <= seen + f64::from(scene.bias);
        if is_lit { weight(x, share.x) * weight(y, share.y) } else { 0.0 }
    };
    (0..16).map(|i| lit(f64::from(i & 3), f64::from(i >> 2))).sum::<f64>() / 9.0
}

fn on_screen(lens: &LensUniform, at: DVec3) -> DVec2 {
    let [center, focal] = [lens.center, lens.focal].map(|v| DVec2::from_array(v.map(f64::from)));
    let scale = if lens.is_perspective == 1 { -1.0 / at.z } else { 1.0 };
    center + scale * DVec2::new(focal.x * at.x, -(f64::from(lens.skew) * at.x + focal.y * at.y))
}

/// The distance that a depth stands for.
fn scene_at(lens: &LensUniform, depth: f32) -> f64 {
    let nearness = (f64::from(depth) - f64::from(lens.depth_offset)) * f64::from(lens.depth_scale);
    if lens.is_perspective == 0 {
        return (1.0 - nearness) / f64::from(lens.nearness_slope);
    }
    if nearness > 0.0 { 1.0 / nearness } else { f64::INFINITY }
}
