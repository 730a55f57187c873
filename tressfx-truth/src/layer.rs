//! What a ray passes: pieces of strands in order.

use glam::{DVec3, DVec4};

use crate::cone::RoundCone;
use crate::fibres::{Fibres, Place};
use crate::rays::Ray;

/// What a ray passes in one piece within one strand.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Layer {
    /// Distance from the plane of the eye at which the ray enters, not below that of the near plane.
    pub distance: f64,
    /// Linear RGB, not multiplied by alpha.
    pub color: DVec3,
    /// Opacity.
    pub alpha: f64,
    /// The strand, counted through all sections.
    pub strand: u32,
}

/// What is behind less light than this is not looked at.
const BLACK: f64 = 1e-9;

/// Layers blended front to back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Blend {
    /// Premultiplied.
    color: DVec3,
    transmittance: f64,
}

impl Blend {
    pub(crate) const EMPTY: Self = Self { color: DVec3::ZERO, transmittance: 1.0 };

    /// Puts a layer behind all others, and says how much of it is seen.
    pub(crate) fn add(&mut self, layer: &Layer) -> f64 {
        let weight = self.transmittance * layer.alpha;
        self.color += weight * layer.color;
        self.transmittance *= 1.0 - layer.alpha;
        weight
    }

    /// Whether nothing behind can be seen.
    pub(crate) fn is_closed(&self) -> bool {
        self.transmittance < BLACK
    }

    /// Premultiplied colour and alpha.
    pub(crate) fn color(&self) -> DVec4 {
        self.color.extend(self.alpha())
    }

    pub(crate) fn alpha(&self) -> f64 {
        1.0 - self.transmittance
    }
}

/// The part of a ray in one segment.
#[derive(Clone, Copy, Debug)]
struct Hit {
    enter: f64,
    exit: f64,
    /// How deep the entry is in the segment: below 0 only where the ray begins inside.
    power: f64,
    place: Place,
    strand: u32,
}

/// The part of a ray that counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    pub(crate) near: f64,
    /// Of the opaque scene.
    pub(crate) far: f64,
}

/// Hits of one ray, given in any order and taken out as layers in the order of their distance.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hits {
    waiting: Vec<Hit>,
    /// How far each strand reaches that was entered.
    inside: Vec<(u32, f64)>,
}

impl Hits {
    pub(crate) fn clear(&mut self) {
        self.waiting.clear();
        self.inside.clear();
    }

    /// Takes the part of the ray in a segment, if there is one within the range.
    pub(crate) fn take(&mut self, ray: &Ray, range: Range, fibres: &Fibres, segment: u32, cone: &RoundCone) {
        let Some(part) = cone.interval(ray).filter(|part| part.exit > range.near && part.enter <= range.far) else {
            return;
        };
        let enter = part.enter.max(range.near);
        let (t, power) = cone.deepest(ray.at(enter));
        let power = if enter > part.enter { power } else { 0.0 };
        let place = Place { segment, t };
        self.waiting.push(Hit { enter, exit: part.exit, power, place, strand: fibres.strand(segment) });
    }

    /// Hands out the layers that begin nearer than `horizon`, nearest first. Hits before it must all have been taken.
    pub(crate) fn settle(&mut self, horizon: f64, fibres: &Fibres, sink: &mut impl FnMut(&Layer, Place)) {
        if self.waiting.is_empty() {
            return;
        }
        let order = |a: &Hit, b: &Hit| {
            a.enter.total_cmp(&b.enter).then(a.power.total_cmp(&b.power)).then(a.place.segment.cmp(&b.place.segment))
        };
        self.waiting.sort_unstable_by(order);
        let settled = self.waiting.partition_point(|hit| hit.enter < horizon);
        for hit in self.waiting.drain(..settled) {
            let inside = self.inside.iter_mut().find(|(strand, _)| *strand == hit.strand);
            match inside {
                Some((_, exit)) if hit.enter <= *exit => {
                    *exit = exit.max(hit.exit);
                    continue;
                }
                Some((_, exit)) => *exit = hit.exit,
                None => self.inside.push((hit.strand, hit.exit)),
            }
            let color = fibres.color(hit.place);
            let layer = Layer { distance: hit.enter, color: color.truncate(), alpha: color.w, strand: hit.strand };
            sink(&layer, hit.place);
        }
    }
}
