//! `hair.render.fill`.

use glam::{DVec2, DVec3, DVec4};

use super::{Section, matrix};
use crate::gpu::Frame;

/// What a strand leaves in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// Column and row.
    pub pixel: [u32; 2],
    /// 1 / distance from the plane of the eye.
    pub nearness: f64,
    /// Colour of the strand, not multiplied by alpha.
    pub color: DVec3,
    /// Coverage times opacity.
    pub alpha: f64,
}

/// The fragments of a section. `colors` holds colour and opacity of each strand vertex, in the order of the positions;
/// `scene` is the depth of what is opaque at a pixel.
pub fn fill(
    frame: &Frame,
    section: &Section,
    colors: &[DVec4],
    scene: &dyn Fn([u32; 2]) -> f32,
    sink: &mut dyn FnMut(Fragment),
) {
    for vertex in 0..section.uniform.vertices - 1 {
        for strand in 0..section.uniform.strands {
            if let Some(ribbon) = Ribbon::new(frame, section, colors, strand, vertex) {
                ribbon.walk(frame, scene, sink);
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
    /// Colour and opacity.
    color: DVec4,
}

struct Ribbon([Corner; 2]);

impl Ribbon {
    fn new(frame: &Frame, section: &Section, colors: &[DVec4], strand: u32, vertex: u32) -> Option<Self> {
        let of = &section.uniform;
        let indices = [vertex, vertex + 1].map(|vertex| section.index(strand, vertex));
        let sound = |x: &f32| x.abs() < 1e12;
        if !indices.iter().all(|&i| section.positions[i][..3].iter().all(sound)) {
            return None;
        }
        let width = |vertex: u32| {
            let share = f64::from(section.thickness[(vertex * of.guides + strand % of.guides) as usize]);
            let tip = f64::from(of.tip_width);
            f64::from(of.fibre_radius) * (tip + (1.0 - tip) * share)
        };
        let view = matrix(&frame.view);
        let ends = indices.map(|i| view.transform_point3(section.posed(i)));
        let radii = [width(vertex), width(vertex + 1)];
        let near = f64::from(frame.near);
        let distances = ends.map(|end| -end.z);
        if distances[0].max(distances[1]) <= near {
            return None;
        }
        let crossing = (near - distances[0]) / (distances[1] - distances[0]);
        let corner = |end: usize| {
            let t = if distances[end] < near { crossing } else { end as f64 };
            let point = ends[0].lerp(ends[1], t);
            let nearness = 1.0 / (-point.z).max(near);
            let scale = f64::from(frame.focal) * nearness;
            Corner {
                at: 0.5 * size(frame) + point.truncate() * DVec2::new(scale, -scale),
                half_width: (radii[0] + (radii[1] - radii[0]) * t) * scale,
                nearness,
                color: colors[indices[0]].lerp(colors[indices[1]], t),
            }
        };
        Some(Self([corner(0), corner(1)]))
    }

    fn walk(&self, frame: &Frame, scene: &dyn Fn([u32; 2]) -> f32, sink: &mut dyn FnMut(Fragment)) {
        let [a, b] = self.0;
        let delta = b.at - a.at;
        if delta.length_squared() < 1e-12 {
            return;
        }
        let normal = delta.normalize().perp();
        let margin = a.half_width.max(b.half_width) + 1.0;
        let low = (a.at.min(b.at) - margin).max(DVec2::ZERO).as_uvec2();
        let high = (a.at.max(b.at) + margin).min(size(frame)).max(DVec2::ZERO).ceil().as_uvec2();
        for (y, x) in (low.y..high.y).flat_map(|y| (low.x..high.x).map(move |x| (y, x))) {
            let offset = DVec2::new(f64::from(x), f64::from(y)) + 0.5 - a.at;
            let t = offset.dot(delta) / delta.length_squared();
            if (0.0..1.0).contains(&t) {
                let fragment = self.fragment([x, y], t, offset.dot(normal), normal);
                let behind = f64::from(scene([x, y]) - frame.depth_offset) * f64::from(frame.depth_scale);
                if fragment.nearness >= behind && (fragment.alpha * 65535.0).round() >= 1.0 {
                    sink(fragment);
                }
            }
        }
    }

    fn fragment(&self, pixel: [u32; 2], t: f64, distance: f64, normal: DVec2) -> Fragment {
        let [a, b] = self.0;
        let mix = |a: f64, b: f64| a + (b - a) * t;
        let nearness = mix(a.nearness, b.nearness);
        let color = a.color.lerp(b.color, t * b.nearness / nearness);
        let covered = coverage(distance, mix(a.half_width, b.half_width), normal);
        Fragment { pixel, nearness, color: color.truncate(), alpha: (covered * color.w).clamp(0.0, 1.0) }
    }
}

fn size(frame: &Frame) -> DVec2 {
    DVec2::new(f64::from(frame.size[0]), f64::from(frame.size[1]))
}
