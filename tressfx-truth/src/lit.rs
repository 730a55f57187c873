//! The colour of a layer in the light that reaches it.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use crate::error::TruthError;
use crate::fibres::{Fibres, Part, Place};
use crate::light::{Illumination, Light, LitSection, ShadowMethod};
use crate::nearest::{DepthMap, From};
use crate::opaque::Opaque;
use crate::rays::Rays;
use crate::shadow::{ShadowWork, Shadows, Start};

/// Where a light is, in the space of the eye.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// Of length 1.
    Directional(DVec3),
    Point(DVec3),
    Shadowless,
}

impl Source {
    /// From where, if it is shaded.
    fn shines_from(&self) -> Option<From> {
        match *self {
            Self::Directional(towards) => Some(From::Way(-towards)),
            Self::Point(position) => Some(From::Point(position)),
            Self::Shadowless => None,
        }
    }
}

/// Illumination, ready for layers.
#[derive(Debug)]
pub(crate) struct Lit {
    rays: Rays,
    shadows: Shadows,
    /// Of each source, where strands shade by the nearest fibre.
    maps: Option<Vec<Option<DepthMap>>>,
    sources: Vec<Source>,
    sky: DVec3,
    ground: DVec3,
    /// At each vertex, in the order of the fibres: a colour for each light, and one for the sky.
    colors: Vec<[f32; 3]>,
    /// Of each section the end of its strands, and how much of the shadow is seen.
    self_shadows: Vec<(u32, f64)>,
}

/// Which of the layers along a ray is looked at for all of them, with the probability of its share of what is seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pick {
    /// A number in [0, 1) that looks random whatever was picked so far.
    chance: f64,
    sum: f64,
    pub(crate) place: Option<Place>,
}

impl Pick {
    pub(crate) fn new(chance: f64) -> Self {
        Self { chance, sum: 0.0, place: None }
    }

    /// The next layer. It takes the place of the one that was picked with the probability `weight / sum`.
    pub(crate) fn offer(&mut self, weight: f64, place: Place) {
        if weight <= 0.0 {
            return;
        }
        self.sum += weight;
        let share = weight / self.sum;
        if self.place.is_none() || self.chance < share {
            (self.place, self.chance) = (Some(place), self.chance / share);
        } else {
            self.chance = (self.chance - share) / (1.0 - share);
        }
    }
}

impl Lit {
    pub(crate) fn new(rays: &Rays, fibres: &Fibres, light: &Illumination) -> Result<Self, TruthError> {
        let parts = fibres.parts();
        let vertices = |part: &Part| part.strands.len() * part.shape.vertices as usize;
        light.check(&parts.iter().map(vertices).collect::<Vec<_>>())?;
        let through: Vec<f64> = light.sections.iter().map(|section| 1.0 - f64::from(section.shadow_alpha)).collect();
        let source = |light: &Light| match light {
            Light::Directional { towards } => Source::Directional(rays.turned(towards.as_dvec3()).normalize()),
            Light::Point { position } => Source::Point(rays.in_eye_space(position.as_dvec3())),
            Light::Shadowless => Source::Shadowless,
        };
        let sections = || parts.iter().zip(light.sections);
        let mut colors = Vec::new();
        for (part, section) in sections() {
            let order = (0..part.strands.len() as u32).flat_map(|s| (0..part.shape.vertices).map(move |v| (s, v)));
            let index = order.map(|(strand, vertex)| part.shape.index(strand, vertex) as usize);
            colors.extend(index.flat_map(|index| all_colors(section, index)));
        }
        let sources: Vec<Source> = light.lights.iter().map(source).collect();
        let maps = match light.shadows {
            ShadowMethod::Traced => None,
            ShadowMethod::NearestFibre { spacing } => {
                Some(sources.iter().map(|source| DepthMap::new(fibres, source.shines_from()?, spacing)).collect())
            }
        };
        Ok(Self {
            rays: *rays,
            shadows: Shadows::new(fibres, &through, Opaque::new(rays, light.meshes)?),
            maps,
            sources,
            sky: light.sky.as_dvec3(),
            ground: light.ground.as_dvec3(),
            colors,
            self_shadows: sections().map(|(part, section)| (part.strands.end, section.self_shadow.into())).collect(),
        })
    }

    /// The colour of a layer. For the light of the whole sky stands that from one direction, which two numbers in [0, 1) choose.
    pub(crate) fn color(&self, work: &mut ShadowWork, fibres: &Fibres, place: Place, sky: DVec2) -> DVec3 {
        let (point, radius) = fibres.axis(place);
        let start = Start { point, radius, strand: fibres.strand(place.segment) };
        let self_shadow = self.self_shadow(start.strand);
        let mut sum = DVec3::ZERO;
        for (index, source) in self.sources.iter().enumerate() {
            let color = self.channel(place, index);
            let (towards, end) = match source {
                Source::Directional(towards) => (*towards, f64::INFINITY),
                Source::Point(position) => (*position - point).normalize_and_length(),
                Source::Shadowless => (DVec3::ZERO, 0.0),
            };
            let is_shaded = self_shadow > 0.0 && end > 0.0 && color != DVec3::ZERO;
            let light = match &self.maps {
                _ if !is_shaded => 1.0,
                None => self.shadows.light(work, fibres, &start, towards, end),
                Some(_) if self.shadows.is_blocked(work, &start, towards, end) => 0.0,
                Some(maps) => {
                    let through = self.shadows.through(start.strand);
                    maps[index].as_ref().map_or(1.0, |map| map.light(point, through))
                }
            };
            sum += color * (1.0 + self_shadow * (light - 1.0));
        }
        let color = self.channel(place, self.sources.len());
        let open = 0.5 * (self.sky + self.ground);
        if self_shadow == 0.0 || color * open == DVec3::ZERO || self.maps.is_some() {
            return sum + color * open;
        }
        let height = 1.0 - 2.0 * sky.x;
        let (sine, cosine) = (TAU * sky.y).sin_cos();
        let towards = DVec3::new(cosine, 0.0, sine) * (1.0 - height * height).max(0.0).sqrt() + height * DVec3::Y;
        let light = self.shadows.light(work, fibres, &start, self.rays.turned(towards), f64::INFINITY);
        sum + color * open.lerp(light * self.ground.lerp(self.sky, 0.5 + 0.5 * height), self_shadow)
    }

    /// The colour of a layer in the light of that number, unshaded; the sky comes after all lights.
    fn channel(&self, place: Place, number: usize) -> DVec3 {
        let channels = self.sources.len() + 1;
        let vertex = place.segment as usize;
        let [a, b] = [vertex, vertex + 1]
            .map(|vertex| DVec3::from_array(self.colors[vertex * channels + number].map(f64::from)));
        a.lerp(b, place.t)
    }

    fn self_shadow(&self, strand: u32) -> f64 {
        self.self_shadows[self.self_shadows.partition_point(|(end, _)| *end <= strand)].1
    }
}

/// The colours of a vertex of a section in each light, and under the sky.
fn all_colors<'a>(section: &'a LitSection, index: usize) -> impl Iterator<Item = [f32; 3]> + use<'a> {
    section.lights.iter().map(move |colors| colors[index]).chain([section.sky[index]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_layer_is_picked_as_often_as_its_weight_says() {
        let weights = [0.25, 0.0, 0.5, 0.125, 0.01, 0.0];
        let count = 100_000;
        let mut picked = [0; 6];
        for number in 0..count {
            let mut pick = Pick::new(f64::from(number) / f64::from(count));
            weights.iter().zip(0..).for_each(|(&weight, segment)| pick.offer(weight, Place { segment, t: 0.0 }));
            picked[pick.place.unwrap().segment as usize] += 1;
        }
        let sum: f64 = weights.iter().sum();
        for (found, weight) in picked.into_iter().zip(weights) {
            assert!((f64::from(found) - f64::from(count) * weight / sum).abs() <= 3.0, "{picked:?}");
        }
        let mut nothing = Pick::new(0.0);
        nothing.offer(0.0, Place { segment: 0, t: 0.0 });
        assert!(nothing.place.is_none());
    }
}
