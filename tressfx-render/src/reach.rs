//! What is left out of a frame: sections that no view can see, on the CPU, before anything is written.

use glam::{DMat4, DVec3, DVec4, Vec3};
use tressfx_core::backend::DepthOrder;
use tressfx_core::strands::Strands;
use tressfx_core::view::View;

use crate::lights::LightPlace;
use crate::strands::SectionDraw;
use crate::views::ViewDraw;

/// By how much longer than at rest a strand may be: `Solver::TressFx` stretches.
const STRETCH: f32 = 1.5;

/// Pixels beyond the picture in which something is drawn that reaches into it.
const MARGIN: f64 = 4.0;

/// Sky is taken by hair that is nearer than so many times the radii of both: beyond that it hides less than 2 % of it.
const SKY: f64 = 2.0;

/// Of the square of a distance.
const ROUNDING: f64 = 1e-12;

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
struct Ball {
    center: Vec3,
    radius: f32,
}

impl Ball {
    fn of(draw: &SectionDraw) -> Self {
        let (strands, center) = (draw.strands, draw.pose.translation);
        let fibre = strands.radius(draw.material) * draw.lod.widening(draw.drawn_shape());
        // More than what is lost where the numbers are added.
        Self { center, radius: (strands.reach + fibre + draw.farthest_copy()) * (1.0 + 4.0 * f32::EPSILON) }
    }

    /// One that holds all of these, if there are any.
    fn around(balls: &[Self]) -> Option<Self> {
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

    /// Whether it may take light from another one.
    fn shades(&self, other: &Self, light: &Casting) -> bool {
        let apart = self.center.as_dvec3() - other.center.as_dvec3();
        let radii = f64::from(self.radius) + f64::from(other.radius);
        let (square, most) = (apart.length_squared(), radii * radii);
        light.has_sky && square <= SKY * SKY * most
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
    from: Vec<From>,
}

impl Casting {
    fn of(views: &[ViewDraw]) -> Self {
        let has_sky = views.iter().any(|view| view.lights.sky != Vec3::ZERO || view.lights.ground != Vec3::ZERO);
        let lights = views.iter().flat_map(|view| &view.lights.lights).filter(|light| light.casts);
        let from = lights.map(|light| match light.place {
            LightPlace::Directional { towards } => From::Afar(towards.as_dvec3().normalize_or(DVec3::Y)),
            LightPlace::Point { position, .. } => From::Point(position.as_dvec3()),
        });
        Self { has_sky, from: from.collect() }
    }
}

/// The planes beyond which a view sees nothing: the sides of the picture with a margin, and the near plane.
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
    [wide + x, wide - x, high + y, high - y, near].map(|plane| plane / plane.truncate().length())
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
        let light = Casting::of(views);
        // Most shade nothing of what is seen.
        let near = unseen.into_iter().filter(|(_, ball)| ball.shades(&around, &light));
        let shading = near.filter(|(_, ball)| seen.iter().any(|other| ball.shades(other, &light)));
        kept.extend(shading.map(|(draw, _)| *draw));
    }
    let shading = kept.len() - sections;
    (kept, Drawn { sections, unseen: hidden, shading })
}
