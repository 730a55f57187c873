//! `hair.sim.bone_roots` in f64.

use glam::{Affine3A, DQuat, DVec3};
use tressfx_core::body::Influences;

use super::roots::RootPlace;
use super::skin::{blended, cofactors};
use super::triangle_roots::frame_of;

/// Where bones take a root at `root` with a frame whose z is the direction in which its strand grows, relative to the centre of the groom.
pub fn bone_roots(root: DVec3, frame: DQuat, of: &Influences, joints: &[Affine3A], center: DVec3) -> RootPlace {
    let by = blended(of, joints);
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| frame * axis);
    let now = frame_of(by.matrix3 * x, by.matrix3 * y, cofactors(&by.matrix3) * z);
    let rotation = (now * frame.conjugate()).normalize();
    RootPlace { rotation, place: by.transform_point3(root) - center - rotation * (root - center) }
}
