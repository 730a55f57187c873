//! What hair grows on and falls around.

use glam::Vec3;

use tressfx_core::shape::{Capsule, Ellipsoid};

/// How far above a surface a vertex ends up at least, in metres.
const CLEARANCE: f32 = 5e-4;
/// Where the shoulders are, from the front to the back.
const SHOULDER_Z: f32 = -0.03;

/// A head, and what hair falls around below it.
pub(super) struct Body {
    pub(super) head: Ellipsoid,
    /// Neck and shoulders.
    pub(super) bust: Vec<Capsule>,
    /// The space before the face, which hair is combed around; not solid, and not drawn.
    face: Option<Ellipsoid>,
}

impl Body {
    /// A sphere.
    pub(super) fn sphere(center: Vec3, radius: f32) -> Self {
        Self { head: Ellipsoid { center, radii: Vec3::splat(radius) }, bust: Vec::new(), face: None }
    }

    /// The head of an adult, in metres, its centre in the origin, with neck and shoulders.
    pub(super) fn bust() -> Self {
        let capsule =
            |a: [f32; 3], b: [f32; 3], radius_a, radius_b| Capsule { a: a.into(), b: b.into(), radius_a, radius_b };
        Self {
            head: Ellipsoid { center: Vec3::ZERO, radii: Vec3::new(0.078, 0.115, 0.098) },
            bust: vec![
                capsule([0.0, -0.06, -0.025], [0.0, -0.2, -0.035], 0.052, 0.056),
                capsule([-0.14, -0.272, SHOULDER_Z], [0.14, -0.272, SHOULDER_Z], 0.076, 0.076),
            ],
            face: Some(Ellipsoid { center: Vec3::new(0.0, -0.065, 0.085), radii: Vec3::new(0.062, 0.11, 0.065) }),
        }
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

    /// What strands collide with: the head, filled with capsules that leave the roots outside, the neck and the shoulders.
    pub(super) fn capsules(&self) -> Vec<Capsule> {
        self.head.inscribed_capsules().into_iter().chain(self.bust.iter().copied()).collect()
    }

    /// The point, moved out of everything solid.
    pub(super) fn clear(&self, point: Vec3) -> Vec3 {
        self.push_out_of_solids(point, CLEARANCE)
    }

    fn push_out_of_solids(&self, mut point: Vec3, margin: f32) -> Vec3 {
        for capsule in &self.bust {
            let (center, radius) = capsule.nearest(point);
            let from = point - center;
            if from.length_squared() < (radius + margin).powi(2) {
                point = center + from.try_normalize().unwrap_or(Vec3::Y) * (radius + margin);
            }
        }
        lift(point, margin, &self.head)
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
