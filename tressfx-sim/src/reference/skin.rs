//! `hair.sim.skin` in f64.

use glam::{DAffine3, DMat3, DVec3};
use tressfx_core::body::{Influences, MeshPose, SkinnedMesh};

use super::vector::{across, direction_or};

/// Positions and normals of a mesh in a pose. The pose is one of the mesh.
pub fn skin(mesh: &SkinnedMesh, pose: &MeshPose) -> Vec<[DVec3; 2]> {
    let vertices = mesh.positions.iter().zip(&mesh.normals);
    let mut vertices: Vec<[DVec3; 2]> = vertices.map(|(p, n)| [p.as_dvec3(), n.as_dvec3()]).collect();
    for (morph, &weight) in mesh.morphs.iter().zip(&pose.morphs) {
        for offset in &morph.offsets {
            let [position, normal] = &mut vertices[offset.vertex as usize];
            *position += offset.position.as_dvec3() * f64::from(weight);
            *normal += offset.normal.as_dvec3() * f64::from(weight);
        }
    }
    let bound = mesh.influences.iter().zip(&mesh.normals);
    let skinned = |([position, normal], (of, bound)): ([DVec3; 2], (&Influences, &glam::Vec3))| {
        let by = blended(of, &pose.joints);
        let across = cofactors(&by.matrix3) * normal;
        [by.transform_point3(position), across.normalize_or(bound.as_dvec3())]
    };
    vertices.into_iter().zip(bound).map(skinned).collect()
}

/// The tangents of a mesh in a pose, in the plane across its normals; none where it has none. The fourth number stays.
pub fn skin_tangents(mesh: &SkinnedMesh, pose: &MeshPose) -> Vec<DVec3> {
    let posed = skin(mesh, pose);
    let vertices = mesh.tangents.iter().zip(&mesh.influences).zip(posed);
    let tangent = |((tangent, of), [_, normal]): ((&glam::Vec4, &Influences), [DVec3; 2])| {
        let along = blended(of, &pose.joints).matrix3 * tangent.truncate().as_dvec3();
        direction_or(along - normal * normal.dot(along), across(normal))
    };
    vertices.map(tangent).collect()
}

/// The sum of the matrices of joints, each by its weight.
pub(super) fn blended(of: &Influences, joints: &[glam::Affine3A]) -> DAffine3 {
    let mut sum = DAffine3::ZERO;
    for (&joint, &weight) in of.joints.iter().zip(&of.weights) {
        let (joint, weight) = (joints[joint as usize].as_daffine3(), f64::from(weight));
        sum.matrix3 += joint.matrix3 * weight;
        sum.translation += joint.translation * weight;
    }
    sum
}

/// Takes normals to where a matrix takes the planes that they are across.
pub(super) fn cofactors(matrix: &DMat3) -> DMat3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}
