//! All strands of all sections in the space of the eye.

use std::ops::Range;

use glam::{DMat4, DVec3, DVec4};
use tressfx_core::strand_buffers::StrandShape;

use crate::cone::RoundCone;
use crate::error::TruthError;
use crate::rays::Rays;
use crate::section::Section;

/// Coordinates this large are no hair.
const LARGEST: f32 = 1e12;

/// A vertex of a strand.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// NaN where the position is no hair.
    point: DVec3,
    radius: f64,
}

/// Where on a fibre a layer takes its colour.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) segment: u32,
    /// 0 at the first vertex of the segment to 1 at the second.
    pub(crate) t: f64,
}

/// The part of all strands that a section is.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub(crate) shape: StrandShape,
    pub(crate) strands: Range<u32>,
}

/// Vertices strand by strand. Segment `i` goes from vertex `i` to vertex `i + 1`; the last vertex of a strand begins none.
#[derive(Debug, Default)]
pub(crate) struct Fibres {
    vertices: Vec<Vertex>,
    colors: Vec<[f32; 4]>,
    /// The strand of each vertex, counted through all sections.
    strands: Vec<u32>,
    /// A section each, in their order.
    parts: Vec<Part>,
}

impl Fibres {
    pub(crate) fn new(rays: &Rays, sections: &[Section]) -> Result<Self, TruthError> {
        for (index, section) in sections.iter().enumerate() {
            section.check(index)?;
        }
        let count: u64 = sections.iter().map(|section| section.positions.len() as u64).sum();
        if count > u64::from(u32::MAX) {
            return Err(TruthError::TooMany(count));
        }
        let mut fibres = Self::default();
        fibres.vertices.reserve_exact(count as usize);
        fibres.colors.reserve_exact(count as usize);
        fibres.strands.reserve_exact(count as usize);
        let mut first = 0;
        for section in sections {
            let count = if section.positions.is_empty() { 0 } else { section.shape.strands() };
            let strands = first..first + count;
            first = strands.end;
            fibres.add(rays, section, strands.clone());
            fibres.parts.push(Part { shape: section.shape, strands });
        }
        Ok(fibres)
    }

    fn add(&mut self, rays: &Rays, section: &Section, strands: Range<u32>) {
        let pose: DMat4 = section.pose.matrix().as_dmat4();
        for strand in 0..strands.len() as u32 {
            for vertex in 0..section.shape.vertices {
                let index = section.shape.index(strand, vertex) as usize;
                let [x, y, z, _] = section.positions[index];
                let is_sound = [x, y, z].iter().all(|part| part.abs() < LARGEST);
                let local = if is_sound { DVec3::new(x.into(), y.into(), z.into()) } else { DVec3::NAN };
                let point = rays.in_eye_space(pose.transform_point3(local));
                self.vertices.push(Vertex { point, radius: section.radius(strand, vertex) });
                self.colors.push(section.colors[index]);
                self.strands.push(strands.start + strand);
            }
        }
    }

    /// One more than the largest number of a segment.
    pub(crate) fn end(&self) -> u32 {
        self.vertices.len().saturating_sub(1) as u32
    }

    /// The solid of a segment, if there is one.
    pub(crate) fn cone(&self, segment: u32) -> Option<RoundCone> {
        let i = segment as usize;
        let (a, b) = (self.vertices[i], self.vertices[i + 1]);
        let is_sound = self.strands[i] == self.strands[i + 1] && a.point.is_finite() && b.point.is_finite();
        let has_volume = a.radius > 0.0 || b.radius > 0.0;
        (is_sound && has_volume).then_some(RoundCone { a: a.point, radius_a: a.radius, b: b.point, radius_b: b.radius })
    }

    /// The strand of a segment.
    pub(crate) fn strand(&self, segment: u32) -> u32 {
        self.strands[segment as usize]
    }

    /// The sections, in their order.
    pub(crate) fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The point of the axis at a place, and the radius there.
    pub(crate) fn axis(&self, place: Place) -> (DVec3, f64) {
        let i = place.segment as usize;
        let (a, b) = (self.vertices[i], self.vertices[i + 1]);
        (a.point.lerp(b.point, place.t), a.radius + (b.radius - a.radius) * place.t)
    }

    /// Colour and opacity at a place.
    pub(crate) fn color(&self, place: Place) -> DVec4 {
        let i = place.segment as usize;
        let [a, b] = [i, i + 1].map(|vertex| DVec4::from_array(self.colors[vertex].map(f64::from)));
        let color = a.lerp(b, place.t);
        color.truncate().extend(color.w.clamp(0.0, 1.0))
    }
}
