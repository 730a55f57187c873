//! What the strands collide with in a frame.

use glam::{DQuat, DVec3, Quat, Vec3};
use tressfx_core::gpu_struct;
use tressfx_core::shape::Capsule;
use tressfx_core::view::Pose;

use crate::clock::SubStep;
use crate::error::SimError;
use crate::input::check_pose;

/// What strands collide with in one frame. It may be something else in the next frame, or nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider<'a> {
    /// Its shape, in the unit of the file.
    pub shape: ColliderShape,
    /// How it moves.
    pub motion: ColliderMotion,
    /// Indices of the sections that do not collide with it.
    pub except: &'a [usize],
}

/// What a collider is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ColliderShape {
    /// A capsule.
    Capsule(Capsule),
    /// A signed distance field of the simulation's, as [`Fields::shape`](crate::field::Fields::shape) gives it.
    Field {
        /// Its index.
        index: u32,
        /// How often it was made.
        version: u32,
    },
}

/// How a collider moves during a frame. Friction is against this motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColliderMotion {
    /// With the head: the capsule is in the space of the rest pose.
    WithHead,
    /// By itself, evenly from one pose to another: the capsule is in a space of its own, which the poses take to the world.
    Free {
        /// At the beginning of the frame.
        from: Pose,
        /// At its end.
        to: Pose,
    },
}

impl From<Capsule> for ColliderShape {
    fn from(capsule: Capsule) -> Self {
        Self::Capsule(capsule)
    }
}

impl Collider<'_> {
    /// A shape in the space of the rest pose that moves with the head.
    pub fn with_head(shape: impl Into<ColliderShape>) -> Self {
        Self { shape: shape.into(), motion: ColliderMotion::WithHead, except: &[] }
    }

    /// Capsules in the space of the rest pose that move with the head.
    pub fn all_with_head(capsules: &[Capsule]) -> Vec<Self> {
        capsules.iter().copied().map(Self::with_head).collect()
    }

    /// A shape that moves by itself.
    pub fn free(shape: impl Into<ColliderShape>, from: Pose, to: Pose) -> Self {
        Self { shape: shape.into(), motion: ColliderMotion::Free { from, to }, except: &[] }
    }

    /// Checks it.
    ///
    /// # Errors
    /// A number that is not finite, a negative radius, or a rotation that is none.
    pub fn validate(&self, index: usize) -> Result<(), SimError> {
        if matches!(self.shape, ColliderShape::Capsule(capsule) if !capsule.is_sound()) {
            return Err(SimError::UnsoundCapsule { index });
        }
        if let ColliderMotion::Free { from, to } = &self.motion {
            for pose in [from, to] {
                check_pose(pose, "collider.rotation", "collider.translation")?;
            }
        }
        Ok(())
    }

    /// The shape at the end of a sub-step and its motion during the sub-step, both in the space of the head, relative to the
    /// centre of the groom.
    pub(crate) fn at(&self, center: Vec3, sub_step: &SubStep) -> (PlacedShape, CapsuleMotion) {
        let ColliderMotion::Free { from, to } = &self.motion else {
            return (self.shape.placed(DQuat::IDENTITY, -center.as_dvec3()), CapsuleMotion::STILL);
        };
        let [before, now] = [0, 1].map(|end| {
            let (rotation, translation) = between(from, to, sub_step.shares[end]);
            let head = &sub_step.heads[end];
            let to_head = head.rotation.as_dquat().normalize().inverse();
            (to_head * rotation, to_head * (translation - head.translation.as_dvec3()) - center.as_dvec3())
        });
        let rotation = (now.0 * before.0.inverse()).normalize();
        let motion =
            CapsuleMotion { rotation: rotation.as_quat(), translation: (now.1 - rotation * before.1).as_vec3() };
        (self.shape.placed(now.0, now.1), motion)
    }
}

impl ColliderShape {
    /// The shape after its points were rotated and then moved.
    fn placed(&self, rotation: DQuat, translation: DVec3) -> PlacedShape {
        match *self {
            Self::Capsule(capsule) => {
                let place = |point: Vec3| (rotation * point.as_dvec3() + translation).as_vec3();
                PlacedShape::Capsule(Capsule { a: place(capsule.a), b: place(capsule.b), ..capsule })
            }
            Self::Field { index, .. } => {
                PlacedShape::Field { index, rotation: rotation.as_quat(), translation: translation.as_vec3() }
            }
        }
    }
}

/// A shape in the space of the head, relative to the centre of the groom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacedShape {
    /// A capsule.
    Capsule(Capsule),
    /// A field: points of its mesh are rotated, then moved by the translation.
    Field {
        /// Its index.
        index: u32,
        /// The rotation.
        rotation: Quat,
        /// The translation, in the unit of the file.
        translation: Vec3,
    },
}

impl From<Capsule> for PlacedShape {
    fn from(capsule: Capsule) -> Self {
        Self::Capsule(capsule)
    }
}

/// The pose at a share of an even motion; the share may be less than 0.
fn between(from: &Pose, to: &Pose, share: f64) -> (DQuat, DVec3) {
    let [start, end] = [from, to].map(|pose| pose.rotation.as_dquat().normalize());
    let turn = (end * start.inverse()).normalize();
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let rotation = DQuat::from_scaled_axis(share * turn.to_scaled_axis()) * start;
    (rotation, from.translation.as_dvec3().lerp(to.translation.as_dvec3(), share))
}

/// The motion of a capsule during a sub-step, in the space of the head, relative to the centre of the groom: its points are
/// rotated, then moved by the translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapsuleMotion {
    /// The rotation.
    pub rotation: Quat,
    /// The translation, in the unit of the file.
    pub translation: Vec3,
}

impl CapsuleMotion {
    /// That of a capsule that moves with the head.
    pub const STILL: Self = Self { rotation: Quat::IDENTITY, translation: Vec3::ZERO };
}

gpu_struct! {
    /// A capsule as the kernel reads it: in the space of the rest pose, relative to the centre of the groom. Or a field: what `a` and `b` hold then is in
    /// [`GpuCapsule::field`].
    pub(crate) struct GpuCapsule {
        /// Centre of one end.
        pub a: Vec3,
        /// Radius there; negative of a field.
        pub radius_a: f32,
        /// Centre of the other end.
        pub b: Vec3,
        /// Radius there.
        pub radius_b: f32,
    }
}

impl GpuCapsule {
    fn new(shape: PlacedShape) -> Self {
        match shape {
            PlacedShape::Capsule(Capsule { a, b, radius_a, radius_b }) => Self { a, radius_a, b, radius_b },
            PlacedShape::Field { index, rotation, translation } => Self::field(index, rotation, translation),
        }
    }

    /// A field among capsules: in the place of `a` what it is moved by, of the radius there -1 and less by its index, and of `b` and its radius
    /// the quaternion of its rotation. So it takes no binding of its own, of which there are few.
    fn field(index: u32, rotation: Quat, translation: Vec3) -> Self {
        let [x, y, z, w] = rotation.to_array();
        Self { a: translation, radius_a: -1.0 - index as f32, b: Vec3::new(x, y, z), radius_b: w }
    }
}

gpu_struct! {
    /// A [`CapsuleMotion`] as the kernel reads it.
    pub(crate) struct GpuCapsuleMotion {
        /// The rotation.
        pub rotation: glam::Vec4,
        /// The translation.
        pub translation: Vec3,
        /// Of the capsule, where there is room for it: the share of the distance from its surface that a point can move in any direction
        /// and not come inside. The radius of a tapered one changes along its axis.
        pub clear_share: f32,
    }
}

/// See [`GpuCapsuleMotion::clear_share`].
fn clear_share(shape: PlacedShape) -> f32 {
    let PlacedShape::Capsule(Capsule { a, b, radius_a, radius_b }) = shape else { return 1.0 };
    let axis = a.distance(b);
    if axis > 0.0 { axis / (axis + (radius_b - radius_a).abs()) } else { 1.0 }
}

gpu_struct! {
    /// A collider as the kernel reads it.
    pub(crate) struct GpuCollider {
        /// Where it is at the end of the sub-step.
        pub capsule: GpuCapsule,
        /// How it has moved.
        pub motion: GpuCapsuleMotion,
    }
}

/// The capsules and fields of some sub-steps, as they are uploaded.
#[derive(Clone, Debug, Default)]
pub(crate) struct ColliderList {
    pub(crate) colliders: Vec<GpuCollider>,
    /// Where the last list of each section is.
    last: Vec<std::ops::Range<u32>>,
}

impl<S: Into<PlacedShape>> FromIterator<(S, CapsuleMotion)> for ColliderList {
    fn from_iter<I: IntoIterator<Item = (S, CapsuleMotion)>>(shapes: I) -> Self {
        let mut list = Self::default();
        shapes.into_iter().for_each(|(shape, motion)| list.push(shape.into(), motion));
        list
    }
}

impl ColliderList {
    fn push(&mut self, shape: PlacedShape, motion: CapsuleMotion) {
        let CapsuleMotion { rotation, translation } = motion;
        let motion = GpuCapsuleMotion { rotation: rotation.into(), translation, clear_share: clear_share(shape) };
        self.colliders.push(GpuCollider { capsule: GpuCapsule::new(shape), motion });
    }

    pub(crate) fn clear(&mut self) {
        self.colliders.clear();
        self.last.clear();
    }

    /// Adds what a section collides with in a sub-step, and says where it is. What equals an earlier list is not added again:
    /// capsules that move with the head are the same in all sub-steps.
    pub(crate) fn add(&mut self, colliders: &[Collider], section: usize, center: Vec3, sub_step: &SubStep) -> [u32; 2] {
        let first = self.colliders.len();
        for collider in colliders.iter().filter(|collider| !collider.except.contains(&section)) {
            let (shape, motion) = collider.at(center, sub_step);
            self.push(shape, motion);
        }
        let all = &self.colliders;
        let equals = |range: &std::ops::Range<u32>| all[range.start as usize..range.end as usize] == all[first..];
        let found = self.last.iter().find(|range| equals(range)).cloned();
        if found.is_some() {
            self.colliders.truncate(first);
        }
        let range = found.unwrap_or(first as u32..self.colliders.len() as u32);
        if self.last.len() <= section {
            self.last.resize(section + 1, 0..0);
        }
        self.last[section] = range.clone();
        [range.start, range.end]
    }
}
