//! All strands of all sections in the space of the eye.

use glam::{DMat4, DVec3, DVec4};

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

/// Vertices strand by strand. Segment `i` goes from vertex `i` to vertex `i + 1`; the last vertex of a strand begins none.
#[derive(Debug, Default)]
pub(crate) struct Fibres {
    vertices: Vec<Vertex>,
    colors: Vec<[f32; 4]>,
    /// The strand of each vertex, counted through all sections.
    strands: Vec<u32>,
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
        for section in sections.iter().filter(|section| !section.positions.is_empty()) {
            fibres.add(rays, section, first);
            first += section.shape.strands();
        }
        Ok(fibres)
    }

    fn add(&mut self, rays: &Rays, section: &Section, first: u32) {
        let pose: DMat4 = section.pose.matrix().as_dmat4();
        for strand in 0..section.shape.strands() {
            for vertex in 0..section.shape.vertices {
                let index = section.shape.index(strand, vertex) as usize;
                let [x, y, z, _] = section.positions[index];
                let is_sound = [x, y, z].iter().all(|part| part.abs() < LARGEST);
                let local = if is_sound { DVec3::new(x.into(), y.into(), z.into()) } else { DVec3::NAN };
                let point = rays.in_eye_space(pose.transform_point3(local));
                self.vertices.push(Vertex { point, radius: section.radius(strand, vertex) });
                self.colors.push(section.colors[index]);
                self.strands.push(first + strand);
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

    /// Colour and opacity at a share `t` of a segment.
    pub(crate) fn color(&self, segment: u32, t: f64) -> DVec4 {
        let [a, b] = [0, 1].map(|end| DVec4::from_array(self.colors[segment as usize + end].map(f64::from)));
        let color = a.lerp(b, t);
        color.truncate().extend(color.w.clamp(0.0, 1.0))
    }
}
