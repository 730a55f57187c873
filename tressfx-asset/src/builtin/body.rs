//! What hair grows on and falls around.

use glam::Vec3;

use tressfx_core::shape::{Capsule, Ellipsoid};

use super::animal::{self, Part};

/// How far above a surface a vertex ends up at least, in metres.
const CLEARANCE: f32 = 5e-4;
/// How far below the skin of an animal its strands collide: roots are outside.
const BELOW_SKIN: f32 = 2e-3;
/// A point is moved out of the parts of an animal so often, one after the other.
const ROUNDS: usize = 6;
/// Where the shoulders are, from the front to the back.
const SHOULDER_Z: f32 = -0.03;

/// A head, and what hair falls around below it; or an animal.
pub(super) struct Body {
    /// What roots are on; an animal has them on its parts.
    pub(super) head: Option<Ellipsoid>,
    /// Neck and shoulders.
    pub(super) bust: Vec<Capsule>,
    /// Of an animal.
    pub(super) parts: Vec<Part>,
    /// The space before the face, which hair is combed around; not solid, and not drawn.
    face: Option<Ellipsoid>,
}

impl Body {
    /// A sphere.
    pub(super) fn sphere(center: Vec3, radius: f32) -> Self {
        let head = Some(Ellipsoid { center, radii: Vec3::splat(radius) });
        Self { head, bust: Vec::new(), parts: Vec::new(), face: None }
    }

    /// The head of an adult, in metres, its centre in the origin, with neck and shoulders.
    pub(super) fn bust() -> Self {
        let capsule =
            |a: [f32; 3], b: [f32; 3], radius_a, radius_b| Capsule { a: a.into(), b: b.into(), radius_a, radius_b };
        Self {
            head: Some(Ellipsoid { center: Vec3::ZERO, radii: Vec3::new(0.078, 0.115, 0.098) }),
            parts: Vec::new(),
            bust: vec![
                capsule([0.0, -0.06, -0.025], [0.0, -0.2, -0.035], 0.052, 0.056),
                capsule([-0.14, -0.272, SHOULDER_Z], [0.14, -0.272, SHOULDER_Z], 0.076, 0.076),
            ],
            face: Some(Ellipsoid { center: Vec3::new(0.0, -0.065, 0.085), radii: Vec3::new(0.062, 0.11, 0.065) }),
        }
    }

    /// A small animal with four legs and a tail.
    pub(super) fn animal() -> Self {
        Self { head: None, bust: Vec::new(), parts: animal::parts(), face: None }
    }

    /// All that is drawn but the head.
    pub(super) fn solids(&self) -> impl Iterator<Item = &Capsule> {
        self.bust.iter().chain(self.parts.iter().map(|part| &part.solid))
    }

    /// The point, or where it is less than `margin` above a surface, the point moved out to there.
    pub(super) fn push_out(&self, mut point: Vec3, margin: f32) -> Vec3 {
        if let Some(face) = &self.face {
            point = lift(point, 0.0, face);
        }
        self.push_out_of_solids(point, margin.max(CLEARANCE))
    }

    /// Where hair is drawn as it comes down to the shoulders: to the chest or to the back, and in to the neck. Hair that
    /// fell on top of a shoulder would stand out from it like a cape.
    pub(super) fn draw(&self, point: Vec3, to_chest: bool) -> Vec3 {
        if self.bust.is_empty() || !(-0.3..-0.1).contains(&point.y) {
            return Vec3::ZERO;
        }
        let target = SHOULDER_Z + if to_chest { 0.1 } else { -0.1 };
        Vec3::new(-25.0 * point.x, 0.0, 110.0 * (target - point.z))
    }

    /// What strands collide with: the head, filled with capsules that leave the roots outside, the neck and the shoulders; or the
    /// parts of an animal, a little below their skin.
    pub(super) fn capsules(&self) -> Vec<Capsule> {
        let below_skin = |part: &Part| {
            let Capsule { radius_a, radius_b, .. } = part.solid;
            Capsule { radius_a: radius_a - BELOW_SKIN, radius_b: radius_b - BELOW_SKIN, ..part.solid }
        };
        let head = self.head.iter().flat_map(Ellipsoid::inscribed_capsules);
        head.chain(self.bust.iter().copied()).chain(self.parts.iter().map(below_skin)).collect()
    }

    /// Whether a point is outside of neck and shoulders.
    pub(super) fn is_free(&self, point: Vec3) -> bool {
        self.bust.iter().all(|capsule| capsule.distance(point) > CLEARANCE)
    }

    /// The point, moved out of everything solid.
    pub(super) fn clear(&self, point: Vec3) -> Vec3 {
        self.push_out_of_solids(point, CLEARANCE)
    }

    fn push_out_of_solids(&self, mut point: Vec3, margin: f32) -> Vec3 {
        // What leaves one part of an animal may enter another.
        let rounds = if self.parts.is_empty() { 1 } else { ROUNDS };
        for _ in 0..rounds {
            for capsule in self.solids() {
                let (center, radius) = capsule.nearest(point);
                let from = point - center;
                if from.length_squared() < (radius + margin).powi(2) {
                    point = center + from.try_normalize().unwrap_or(Vec3::Y) * (radius + margin);
                }
            }
        }
        self.head.as_ref().map_or(point, |head| lift(point, margin, head))
    }
}

/// Moves a point out of an ellipsoid that is larger by `margin` on all sides.
fn lift(point: Vec3, margin: f32, solid: &Ellipsoid) -> Vec3 {
    let solid = Ellipsoid { radii: solid.radii + margin, ..*solid };
    let level = solid.level(point);
    if level >= 1.0 {
        return point;
    }
    // Along the normal first, which keeps strands apart; the last bit from the centre, which is exact.
    let out = point - solid.normal(point) * solid.distance(point).max(-solid.radii.min_element());
    let level = solid.level(out);
    if level >= 1.0 { out } else { solid.center + (out - solid.center) / level.max(1e-3) * 1.0001 }
}
