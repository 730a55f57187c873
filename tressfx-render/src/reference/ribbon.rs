//! A segment of a strand on the screen.

use glam::{DVec2, DVec4};

use super::coverage::{between, coverage, parts, pixel_length, rise};
use super::joint::{Joint, paint};
use super::projection::{Point, Projection};
use super::{Fragment, Strands};

/// One end of a segment on the screen.
#[derive(Clone, Copy)]
struct Corner {
    at: DVec2,
    half_width: f64,
    nearness: f64,
    /// What attributes interpolate with.
    weight: f64,
    /// Colour and opacity of the surface.
    color: DVec4,
    joint: Joint,
}

pub(super) struct Ribbon {
    first_vertex: u32,
    ends: [Corner; 2],
    delta: DVec2,
    normal: DVec2,
}

impl Ribbon {
    /// The square of a length in pixels: a shorter segment has no direction.
    const SHORTEST: f64 = 1e-12;

    pub(super) fn new(
        projection: &Projection,
        strands: &Strands,
        colors: &[DVec4],
        strand: u32,
        vertex: u32,
    ) -> Option<Self> {
        let vertices = [vertex, vertex + 1];
        if !vertices.iter().all(|&vertex| strands.is_sound(strand, vertex)) {
            return None;
        }
        let radii = vertices.map(|vertex| strands.radius(strand, vertex));
        let paints = vertices.map(|vertex| paint(projection, strands, colors, strand, vertex));
        let whole = vertices.map(|vertex| projection.point(strands.point(strand, vertex)));
        let parts = projection.visible(&whole)?;
        let points: [Point; 2] = parts.map(|t| projection.point(whole[0].world.lerp(whole[1].world, t)));
        let at = [projection.pixel(&points[0]), projection.pixel(&points[1])];
        let mut delta = at[1] - at[0];
        let joints = [0, 1].map(|end| match parts[end] == end as f64 {
            true => Joint::at(projection, strands, strand, vertices[end]),
            false => Joint::AHEAD,
        });
        if delta.length_squared() < Self::SHORTEST {
            if !joints.contains(&Joint::Round) {
                return None;
            }
            delta = DVec2::X * Self::SHORTEST.sqrt();
        }
        let normal = delta.normalize().perp();
        let corner = |end: usize| Corner {
            at: at[end],
            half_width: projection.half_width(&points[end], radii[0] + (radii[1] - radii[0]) * parts[end], normal),
            nearness: projection.nearness(&points[end]),
            weight: Projection::weight(&points[end]),
            color: paints[0].lerp(paints[1], parts[end]),
            joint: joints[end],
        };
        Some(Self { first_vertex: strands.number(strand, vertex), ends: [corner(0), corner(1)], delta, normal })
    }

    pub(super) fn walk(
        &self,
        projection: &Projection,
        scene: &dyn Fn([u32; 2]) -> f32,
        sink: &mut dyn FnMut(Fragment),
    ) {
        let [a, b] = self.ends;
        let size = DVec2::new(f64::from(projection.size[0]), f64::from(projection.size[1]));
        let margin = 2.0 * (a.half_width.max(b.half_width) + 1.0);
        let low = (a.at.min(b.at) - margin).max(DVec2::ZERO).as_uvec2();
        let high = (a.at.max(b.at) + margin).min(size).max(DVec2::ZERO).ceil().as_uvec2();
        for (y, x) in (low.y..high.y).flat_map(|y| (low.x..high.x).map(move |x| (y, x))) {
            let Some(fragment) = self.fragment([x, y]) else { continue };
            let behind = projection.nearness_of_depth(f64::from(scene([x, y])));
            if fragment.nearness >= behind && (fragment.alpha * 65535.0).round() >= 1.0 {
                sink(fragment);
            }
        }
    }

    /// Nothing where the pixel belongs to another segment of the strand.
    fn fragment(&self, pixel: [u32; 2]) -> Option<Fragment> {
        let [a, b] = self.ends;
        let length = self.delta.length();
        let offset = DVec2::new(f64::from(pixel[0]), f64::from(pixel[1])) + 0.5 - a.at;
        let at = DVec2::new(offset.dot(self.delta) / length, offset.dot(self.normal));
        let is_begun = a.joint.is_behind(at, -1.0).unwrap_or(true);
        let is_ended = b.joint.is_behind(at - DVec2::X * length, 1.0).unwrap_or(false);
        if !is_begun || is_ended {
            return None;
        }
        let place = (at.x / length).clamp(0.0, 1.0);
        let mix = |a: f64, b: f64| a + (b - a) * place;
        let half_width = mix(a.half_width, b.half_width);
        let mut covered = coverage(at.y, half_width, self.normal);
        if a.joint.is_sharp() || b.joint.is_sharp() {
            let rise = rise(at.y, half_width);
            let whole = pixel_length(self.normal);
            let has_joint = [a, b].iter().any(|end| end.joint != Joint::Round);
            let pixel = if has_joint { (2.0 * (length + rise)).clamp(0.5, whole) } else { whole };
            covered *= between(at.x + rise + a.joint.slack(), length - at.x + rise + b.joint.slack(), pixel);
        }
        let color = a.color.lerp(b.color, place * b.weight / mix(a.weight, b.weight));
        Some(Fragment {
            pixel,
            segment: self.first_vertex,
            nearness: mix(a.nearness, b.nearness),
            color: color.truncate(),
            alpha: (covered * color.w).clamp(0.0, 1.0),
            parts: (parts(at.y, half_width, self.normal, covered.min(1.0)) * color.w).clamp(DVec4::ZERO, DVec4::ONE),
        })
    }
}
