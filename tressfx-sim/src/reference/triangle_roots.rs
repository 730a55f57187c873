//! `hair.sim.triangle_roots` in f64.

use glam::{DMat3, DQuat, DVec3};

use super::roots::RootPlace;
use crate::body::BoundRoot;

/// As in the kernel: a triangle whose sine between two edges is smaller than the root of this has no plane.
const FLAT: f64 = 1e-12;

/// Where a mesh takes a root, relative to the centre of the groom. `last` is what it was; a triangle that has collapsed keeps its rotation.
pub fn triangle_roots(root: &BoundRoot, positions: &[DVec3], center: DVec3, last: &RootPlace) -> RootPlace {
    let [a, b, c] = root.corners.map(|corner| positions[corner as usize] - center);
    let (one, other) = (b - a, c - a);
    let normal = one.cross(other);
    let is_flat = normal.length_squared() <= FLAT * one.length_squared() * other.length_squared();
    let frame = if is_flat {
        last.rotation * root.frame
    } else {
        let [tangent, bitangent] = root.edges.map(|edges| one * edges.x + other * edges.y);
        frame_of(tangent, bitangent, normal)
    };
    let rotation = if is_flat { last.rotation } else { (frame * root.frame.conjugate()).normalize() };
    let place = a + one * root.place.x + other * root.place.y + frame * root.offset;
    RootPlace { rotation, place: place - rotation * (root.root - center) }
}

/// The frame of a plane in which two vectors that were unit and perpendicular are now these: of all rotations within the plane the one nearest to
/// what became of them.
pub(super) fn frame_of(tangent: DVec3, bitangent: DVec3, normal: DVec3) -> DQuat {
    let z = normal.normalize();
    let x = tangent + bitangent.cross(z);
    let x = (x - z * x.dot(z)).normalize();
    DQuat::from_mat3(&DMat3::from_cols(x, z.cross(x), z)).normalize()
}
