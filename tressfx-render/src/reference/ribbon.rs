//! A segment of a strand on the screen.

use std::f64::consts::FRAC_PI_4;

use glam::{DVec2, DVec3, DVec4};

use super::coverage::{Stripe, between, coverage, pixel_length, rise};
use super::joint::Joint;
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
    joint: Joint,
}

pub(super) struct Ribbon {
    first_vertex: u32,
    ends: [Corner; 2],
    delta: DVec2,
    normal: DVec2,
    /// Colour and opacity at the ends of the segment.
    paints: [DVec4; 2],
    /// Where the corners are on the segment, 0 to 1.
    parts: [f64; 2],
    /// By how much of the segment the surface is farther along it than the axis, for each pixel by which it rises.
    slant: f64,
}

impl Ribbon {
    /// The square of a length in pixels: a shorter segment has no direction.
    const SHORTEST: f64 = 1e-12;
    /// By how much of its length a segment goes on with its colours.
    const SURPLUS: f64 = 0.5;
    /// Half a width in pixels up to which a pixel sees all of a fibre.
    const THIN: f64 = 0.5;

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
        let paints = vertices.map(|vertex| colors[strands.index(strand, vertex)]);
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
            joint: joints[end],
        };
        Some(Self {
            first_vertex: strands.number(strand, vertex),
            ends: [corner(0), corner(1)],
            delta,
            normal,
            paints,
            parts,
            slant: slant(projection, &points, normal) * (parts[1] - parts[0]),
        })
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
        let along = place * b.weight / mix(a.weight, b.weight);
        let axis = self.parts[0] + (self.parts[1] - self.parts[0]) * along;
        let seen = if half_width > Self::THIN { rise(at.y, half_width) } else { FRAC_PI_4 * half_width };
        let surface = (axis + seen * self.slant).clamp(-Self::SURPLUS, 1.0 + Self::SURPLUS);
        let paint = |at: f64| self.paints[0].lerp(self.paints[1], at);
        let (color, opacity) = (paint(surface).truncate().max(DVec3::ZERO), paint(axis).w);
        Some(Fragment {
            pixel,
            segment: self.first_vertex,
            nearness: mix(a.nearness, b.nearness),
            color,
            alpha: (covered * opacity).clamp(0.0, 1.0),
            stripe: Stripe { distance: at.y, half_width, normal: self.normal },
        })
    }
}

/// By how much of its length the surface of a round segment is farther along it than its axis, for each pixel by which it rises: the
/// cotangent of the angle between it and the ray through its middle on the screen, over its length.
fn slant(projection: &Projection, ends: &[Point; 2], normal: DVec2) -> f64 {
    let [near, far] = [0, 1].map(|end| Projection::weight(&ends[end]));
    let middle = ends[0].world.lerp(ends[1].world, far / (near + far));
    let (axis, ray) = (ends[1].world - ends[0].world, projection.towards_eye(middle));
    let pixels = projection.half_width(&projection.point(middle), 1.0, normal);
    axis.dot(ray) / (axis.cross(ray).length() * axis.length() * pixels).max(1e-30)
}
