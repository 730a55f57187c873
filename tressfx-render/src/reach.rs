//! What is left out of a frame: sections that no view can see, on the CPU, before anything is written.

use std::array;

use glam::{DMat4, DVec3, DVec4, Vec3, Vec4};
use tressfx_core::backend::DepthOrder;
use tressfx_core::strands::Strands;
use tressfx_core::view::View;

use crate::lights::{LightPlace, Lights};
use crate::strands::SectionDraw;
use crate::views::ViewDraw;

/// By how much longer than at rest a strand may be: `Solver::TressFx` stretches.
const STRETCH: f32 = 1.5;

/// Pixels beyond the picture in which something is drawn that reaches into it.
pub(crate) const MARGIN: f64 = 4.0;

/// Sky is taken by hair that is nearer than twice the radii of both: beyond that it hides less than 2 % of it. This is the square.
const SKY_SQUARE: f32 = 4.0;

/// Of the square of a distance.
const ROUNDING: f64 = 1e-12;

/// The same of floats of 32 bits, and more than that.
const COARSE: f32 = 1e-5;

/// What a frame has drawn and left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Drawn {
    /// Sections that were drawn.
    pub sections: usize,
    /// Sections that no view can see: they have no pass but those of the shadows that they throw on others.
    pub unseen: usize,
    /// Those of them that throw shadows.
    pub shading: usize,
}

/// A point and a distance from it within which strands are, however their head turns and they swing: the roots ride on the head, and a strand is no
/// longer than [`STRETCH`] times its length.
pub(crate) fn of(strands: &Strands) -> (Vec3, f32) {
    let vertices = strands.vertices as usize;
    let all = strands.rest_of_all();
    let roots = || all.iter().step_by(vertices).map(|root| root.truncate());
    let low = roots().fold(Vec3::INFINITY, Vec3::min);
    let middle = low.midpoint(roots().fold(Vec3::NEG_INFINITY, Vec3::max));
    let lengths: Vec<f32> = strands.rest_lengths.chunks(vertices).map(|strand| strand.iter().sum()).collect();
    // Follow strands spread from their guides by this share of their offset.
    let offset = strands.follow_offsets.iter().map(|offset| offset.truncate().length()).fold(0.0, f32::max);
    let spread = offset * strands.tip_separation.max(0.0);
    let reach = roots().enumerate().map(|(i, root)| root.distance(middle) + STRETCH * lengths[i % lengths.len()]);
    let reach = reach.fold(0.0, f32::max) + spread;
    if middle.is_finite() && reach.is_finite() { (middle, reach) } else { (Vec3::ZERO, f32::INFINITY) }
}

/// What holds a section, in the world. Small, since there may be thousands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball {
    pub(crate) center: Vec3,
    pub(crate) radius: f32,
}

impl Ball {
    pub(crate) fn of(draw: &SectionDraw) -> Self {
        let (strands, center) = (draw.strands, draw.pose.translation);
        let fibre = strands.radius(draw.material) * draw.lod.widening(draw.drawn_shape());
        // More than what is lost where the numbers are added.
        Self { center, radius: (strands.reach + fibre + draw.farthest_copy()) * (1.0 + 4.0 * f32::EPSILON) }
    }

    /// One that holds all of these, if there are any.
    fn around(balls: &[Self]) -> Option<Self> {
        if let Some(endless) = balls.iter().find(|ball| ball.radius == f32::INFINITY) {
            return Some(*endless);
        }
        let reach = |ball: &Self| DVec3::splat(ball.radius.into());
        let low = balls.iter().map(|ball| ball.center.as_dvec3() - reach(ball)).reduce(DVec3::min)?;
        let high = balls.iter().map(|ball| ball.center.as_dvec3() + reach(ball)).reduce(DVec3::max)?;
        let center = low.midpoint(high).as_vec3();
        let radius = 0.5 * low.distance(high) + center.as_dvec3().distance(low.midpoint(high));
        Some(Self { center, radius: radius as f32 * (1.0 + f32::EPSILON) })
    }

    /// Whether a view may see any of it.
    fn is_seen(&self, planes: &[DVec4]) -> bool {
        // What is no number is not known to be outside.
        let (center, radius) = (self.center.as_dvec3().extend(1.0), f64::from(self.radius));
        !planes.iter().any(|plane| plane.dot(center) < -radius)
    }

    /// Whether it may take light from another one, so far as four lights at once can be asked in little precision: false where it does not.
    fn may_shade(&self, other: &Self, light: &Casting) -> bool {
        let (apart, radii) = (self.center - other.center, self.radius + other.radius);
        let (square, most) = (apart.length_squared() * (1.0 - COARSE), radii * radii);
        // What is no number is not known to be small.
        let reaches = |[x, y, z]: &[Vec4; 3]| {
            let along = (apart.x * *x + apart.y * *y + apart.z * *z).max(Vec4::ZERO);
            !(Vec4::splat(square) - along * along).cmpgt(Vec4::splat(most)).all()
        };
        light.has_point || light.has_sky && square <= SKY_SQUARE * most || light.towards.iter().any(reaches)
    }

    /// Whether it may take light from another one.
    fn shades(&self, other: &Self, light: &Casting) -> bool {
        let apart = self.center.as_dvec3() - other.center.as_dvec3();
        let radii = f64::from(self.radius) + f64::from(other.radius);
        let (square, most) = (apart.length_squared(), radii * radii);
        light.has_sky && square <= f64::from(SKY_SQUARE) * most
            || light.from.iter().any(|from| match from {
                // The distance from the way of the light, and what rounding may make of it.
                From::Afar(towards) => square - apart.dot(*towards).max(0.0).powi(2) <= most + square * ROUNDING,
                From::Point(position) => {
                    let way = position - other.center.as_dvec3();
                    let along = apart.dot(way) / way.length_squared().max(1e-30);
                    apart.distance_squared(way * along.clamp(0.0, 1.0)) <= most
                }
            })
    }
}

/// Where a light is.
#[derive(Clone, Copy, Debug)]
enum From {
    /// In this direction, of length 1.
    Afar(DVec3),
    /// At this point.
    Point(DVec3),
}

/// The light of all views in which shadows are cast.
#[derive(Debug, Default)]
struct Casting {
    has_sky: bool,
    has_point: bool,
    from: Vec<From>,
    /// The directions of lights far away, four at once: all x, all y and all z. Where there are fewer, some are of length 0.
    towards: Vec<[Vec4; 3]>,
}

impl Casting {
    fn of<'a>(all: impl Iterator<Item = &'a Lights> + Clone) -> Self {
        let has_sky = all.clone().any(|lights| lights.sky != Vec3::ZERO || lights.ground != Vec3::ZERO);
        let lights = all.flat_map(|lights| &lights.lights).filter(|light| light.casts);
        let from = lights.map(|light| match light.place {
            LightPlace::Directional { towards } => From::Afar(towards.as_dvec3().normalize_or(DVec3::Y)),
            LightPlace::Point { position, .. } => From::Point(position.as_dvec3()),
        });
        let from: Vec<From> = from.collect();
        let afar = |from: &From| if let From::Afar(towards) = from { Some(towards.as_vec3()) } else { None };
        let towards: Vec<Vec3> = from.iter().filter_map(afar).collect();
        let axis = |four: &[Vec3], axis: usize| {
            Vec4::from_array(array::from_fn(|i| four.get(i).map_or(0.0, |towards| towards[axis])))
        };
        let four_at_once = |four: &[Vec3]| [0, 1, 2].map(|i| axis(four, i));
        Self {
            has_sky,
            has_point: towards.len() < from.len(),
            towards: towards.chunks(4).map(four_at_once).collect(),
            from,
        }
    }
}

/// The planes beyond which a view sees nothing: the near plane, behind which most is that is not seen, and the sides of the picture with a margin.
fn planes(view: &View) -> [DVec4; 5] {
    let clip: DMat4 = view.projection_matrix().as_dmat4() * view.view_matrix().as_dmat4();
    let w = clip.row(3);
    // A perspective may have any scale, an orthographic view any w.
    let w_sign = if w.truncate() == DVec3::ZERO { w.w.signum() } else { 1.0 };
    let [x, y, z, w] = [clip.row(0), clip.row(1), clip.row(2), w].map(|row| row * w_sign);
    let [wide, high] = view.size().map(|side| w * (1.0 + 2.0 * MARGIN / f64::from(side.max(1))));
    let near = match view.depth() {
        DepthOrder::Standard => z,
        DepthOrder::Reverse => w - z,
    };
    // Distances from them are in the unit of the world.
    [near, wide + x, wide - x, high + y, high - y].map(|plane| plane / plane.truncate().length())
}

/// The sections that a view may see, then those that may throw shadows on these, and how many of each there are. Those without segments are left out.
pub(crate) fn split<'a>(
    views: &[ViewDraw],
    draws: &[SectionDraw<'a>],
    has_shadows: bool,
) -> (Vec<SectionDraw<'a>>, Drawn) {
    let planes: Vec<_> = views.iter().filter(|seen| !seen.view.is_empty()).map(|seen| planes(seen.view)).collect();
    let (mut kept, mut seen, mut unseen) = (Vec::new(), Vec::new(), Vec::with_capacity(draws.len()));
    for draw in draws.iter().filter(|draw| !draw.is_empty()) {
        let ball = Ball::of(draw);
        if planes.iter().any(|planes| ball.is_seen(planes)) {
            kept.push(*draw);
            seen.push(ball);
        } else {
            unseen.push((draw, ball));
        }
    }
    let (sections, hidden) = (kept.len(), unseen.len());
    if let Some(around) = Ball::around(&seen).filter(|_| has_shadows) {
        let light = Casting::of(views.iter().map(|view| view.lights));
        // Most shade nothing of what is seen.
        let near =
            unseen.into_iter().filter(|(_, ball)| ball.may_shade(&around, &light) && ball.shades(&around, &light));
        let shading = near.filter(|(_, ball)| seen.iter().any(|other| ball.shades(other, &light)));
        kept.extend(shading.map(|(draw, _)| *draw));
    }
    let shading = kept.len() - sections;
    (kept, Drawn { sections, unseen: hidden, shading })
}

#[cfg(test)]
mod tests {
    use tressfx_core::hash::hash;

    use super::*;
    use crate::lights::Light;

    /// Random numbers from -1 to 1, by their place.
    fn random(place: u32) -> f32 {
        2.0 * hash(place) as f32 - 1.0
    }

    fn ball(place: u32) -> Ball {
        let center = 20.0 * Vec3::new(random(place), random(place + 1), random(place + 2));
        Ball { center, radius: 1.5 + random(place + 3) }
    }

    fn casting(lights: u32, has_sky: bool) -> Casting {
        let towards = |i: u32| Vec3::new(random(7 * i + 1), random(7 * i + 2), random(7 * i + 3));
        let lights = (0..lights).map(|i| Light::directional(towards(i), Vec3::ONE)).collect();
        let sky = if has_sky { Vec3::ONE } else { Vec3::ZERO };
        Casting::of(std::iter::once(&Lights { sky, ground: Vec3::ZERO, lights }))
    }

    #[test]
    fn what_shades_is_never_left_out_by_the_coarse_test() {
        for (lights, has_sky) in [(0, true), (1, false), (3, true), (6, false), (16, true)] {
            let light = casting(lights, has_sky);
            let pairs = || (0..20_000).map(|i| (ball(100 + 8 * i), ball(104 + 8 * i)));
            let [mut shading, mut kept] = [0, 0];
            for (ball, other) in pairs() {
                let (shades, may) = (ball.shades(&other, &light), ball.may_shade(&other, &light));
                assert!(may || !shades, "{ball:?} {other:?}");
                shading += u32::from(shades);
                kept += u32::from(may);
            }
            assert!(shading > 100 && kept < shading + 20, "{lights} lights: {shading} of {kept} shade");
        }
    }

    #[test]
    fn what_reaches_without_end_may_be_shaded_by_all() {
        let endless = Ball { center: Vec3::ONE, radius: f32::INFINITY };
        let around = Ball::around(&[ball(1), endless, ball(9)]).unwrap();
        let light = casting(1, false);
        assert!((0..50).all(|i| ball(8 * i).may_shade(&around, &light) && ball(8 * i).shades(&around, &light)));
    }
}
