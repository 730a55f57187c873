//! What lets no light through.

use std::ops::ControlFlow;

use glam::DVec3;

use crate::error::TruthError;
use crate::light::OpaqueMesh;
use crate::rays::{Ray, Rays};
use crate::tree::{Boxes, Tree};

/// The triangles of all meshes in the space of the eye.
#[derive(Debug)]
pub(crate) struct Opaque {
    triangles: Vec<[DVec3; 3]>,
    tree: Tree,
}

impl Opaque {
    pub(crate) fn new(rays: &Rays, meshes: &[OpaqueMesh]) -> Result<Self, TruthError> {
        let mut triangles = Vec::new();
        for (index, mesh) in meshes.iter().enumerate() {
            mesh.check(index)?;
            let pose = mesh.pose.matrix().as_dmat4();
            let corner = |i: u32| rays.in_eye_space(pose.transform_point3(mesh.positions[i as usize].as_dvec3()));
            triangles.extend(mesh.indices.as_chunks().0.iter().map(|triangle: &[u32; 3]| triangle.map(corner)));
        }
        let mut boxes = Boxes::with_capacity(triangles.len());
        for (index, [a, b, c]) in (0..).zip(&triangles) {
            boxes.push(a.min(*b).min(*c), a.max(*b).max(*c), index);
        }
        Ok(Self { triangles, tree: Tree::new(boxes) })
    }

    /// Whether a ray meets a triangle, from either side, at a parameter from `start` to `end`.
    pub(crate) fn blocks(&self, stack: &mut Vec<u32>, ray: &Ray, start: f64, end: f64) -> bool {
        let met = self.tree.visit(stack, ray, end, |index| {
            match crossing(ray, &self.triangles[index as usize]).is_some_and(|s| (start..=end).contains(&s)) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        });
        met.is_break()
    }
}

/// Where a ray crosses a triangle (Moeller and Trumbore 1997). One that is seen edge-on, or is flat, is not crossed.
fn crossing(ray: &Ray, [a, b, c]: &[DVec3; 3]) -> Option<f64> {
    let (ab, ac, from) = (*b - *a, *c - *a, ray.origin - *a);
    let (p, q) = (ray.direction.cross(ac), from.cross(ab));
    let determinant = ab.dot(p);
    let (u, v) = (from.dot(p) / determinant, ray.direction.dot(q) / determinant);
    let s = ac.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && s.is_finite()).then_some(s)
}
