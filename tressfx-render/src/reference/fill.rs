//! `hair.render.fill`.

use glam::{DVec2, DVec3, DVec4};
use tressfx_core::view::View;

use super::Strands;
use super::projection::{Point, Projection};

/// What a strand leaves in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Its depth, turned so that more is nearer, and 0 at the far end of the range.
    pub nearness: f64,
    /// Colour of the strand, not multiplied by alpha.
    pub color: DVec3,
    /// Coverage times opacity.
    pub alpha: f64,
}

/// The fragments of a section. `colors` holds colour and opacity of each strand vertex, in the order of the positions;
/// `scene` is the depth of what is opaque at a pixel of the viewport.
pub fn fill(
    view: &View,
    strands: &Strands,
    colors: &[DVec4],
    scene: &dyn Fn([u32; 2]) -> f32,
    sink: &mut dyn FnMut(Fragment),
) {
    fill_projected(&Projection::new(view), strands, colors, scene, sink);
}

pub(super) fn fill_projected(
    projection: &Projection,
    strands: &Strands,
    colors: &[DVec4],
    scene: &dyn Fn([u32; 2]) -> f32,
    sink: &mut dyn FnMut(Fragment),
) {
    for vertex in 0..strands.uniform.vertices - 1 {
        for strand in 0..strands.uniform.strands {
            if let Some(ribbon) = Ribbon::new(projection, strands, colors, strand, vertex) {
                ribbon.walk(projection, scene, sink);
            }
        }
    }
}

/// Area of a unit square within `half_width` of a line with the unit normal `normal` that passes at `distance` from its
/// centre.
pub fn coverage(distance: f64, half_width: f64, normal: DVec2) -> f64 {
    let n = normal.abs();
    let (base, top) = (0.5 * (n.x + n.y), 0.5 * (n.x - n.y).abs());
    // Area on one side of the line, less one half.
    let side = |distance: f64| {
        let x = distance.abs().min(base);
        let missing = if x > top { (x - top) * (x - top) / (2.0 * (base - top)) } else { 0.0 };
        (x - missing).copysign(distance) / (base + top)
    };
    (side(distance + half_width) - side(distance - half_width)).max(0.0)
}

/// One end of a segment on the screen.
#[derive(Clone, Copy)]
struct Corner {
    at: DVec2,
    half_width: f64,
    nearness: f64,
    /// What attributes interpolate with.
    weight: f64,
    /// Colour and opacity.
    color: DVec4,
}

struct Ribbon {
    ends: [Corner; 2],
    delta: DVec2,
    normal: DVec2,
}

impl Ribbon {
    fn new(projection: &Projection, strands: &Strands, colors: &[DVec4], strand: u32, vertex: u32) -> Option<Self> {
        let of = &strands.uniform;
        let indices = [vertex, vertex + 1].map(|vertex| strands.index(strand, vertex));
        let sound = |x: &f32| x.abs() < 1e12;
        if !indices.iter().all(|&i| strands.positions[i][..3].iter().all(sound)) {
            return None;
        }
        let radii = [vertex, vertex + 1].map(|vertex| {
            let share = f64::from(strands.thickness[(vertex * of.guides + strand % of.guides) as usize]);
            let tip = f64::from(of.tip_width);
            f64::from(of.fibre_radius) * (tip + (1.0 - tip) * share)
        });
        let whole = indices.map(|i| projection.point(strands.posed(i)));
        let parts = projection.visible(&whole)?;
        let points: [Point; 2] = parts.map(|t| projection.point(whole[0].world.lerp(whole[1].world, t)));
        let at = [projection.pixel(&points[0]), projection.pixel(&points[1])];
        let delta = at[1] - at[0];
        let normal = delta.normalize_or_zero().perp();
        let corner = |end: usize| Corner {
            at: at[end],
            half_width: projection.half_width(&points[end], radii[0] + (radii[1] - radii[0]) * parts[end], normal),
            nearness: projection.nearness(&points[end]),
            weight: Projection::weight(&points[end]),
            color: colors[indices[0]].lerp(colors[indices[1]], parts[end]),
        };
        Some(Self { ends: [corner(0), corner(1)], delta, normal })
    }

    fn walk(&self, projection: &Projection, scene: &dyn Fn([u32; 2]) -> f32, sink: &mut dyn FnMut(Fragment)) {
        let [a, b] = self.ends;
        let square = self.delta.length_squared();
        if square < 1e-12 {
            return;
        }
        let size = DVec2::new(f64::from(projection.size[0]), f64::from(projection.size[1]));
        let margin = a.half_width.max(b.half_width) + 1.0;
        let low = (a.at.min(b.at) - margin).max(DVec2::ZERO).as_uvec2();
        let high = (a.at.max(b.at) + margin).min(size).max(DVec2::ZERO).ceil().as_uvec2();
        for (y, x) in (low.y..high.y).flat_map(|y| (low.x..high.x).map(move |x| (y, x))) {
            let offset = DVec2::new(f64::from(x), f64::from(y)) + 0.5 - a.at;
            let t = offset.dot(self.delta) / square;
            if (0.0..1.0).contains(&t) {
                let fragment = self.fragment([x, y], t, offset.dot(self.normal));
                let behind = projection.nearness_of_depth(f64::from(scene([x, y])));
                if fragment.nearness >= behind && (fragment.alpha * 65535.0).round() >= 1.0 {
                    sink(fragment);
                }
            }
        }
    }

    fn fragment(&self, pixel: [u32; 2], t: f64, distance: f64) -> Fragment {
        let [a, b] = self.ends;
        let mix = |a: f64, b: f64| a + (b - a) * t;
        let color = a.color.lerp(b.color, t * b.weight / mix(a.weight, b.weight));
        let covered = coverage(distance, mix(a.half_width, b.half_width), self.normal);
        Fragment {
            pixel,
            nearness: mix(a.nearness, b.nearness),
            color: color.truncate(),
            alpha: (covered * color.w).clamp(0.0, 1.0),
        }
    }
}
