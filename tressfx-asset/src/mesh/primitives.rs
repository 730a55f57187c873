//! Meshes of simple solids.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::{Quat, Vec3};

use super::Mesh;
use tressfx_core::shape::{Capsule, Ellipsoid};

impl Mesh {
    /// An ellipsoid of `segments` segments around and half as many from pole to pole (at least 3 and 2).
    pub fn ellipsoid(ellipsoid: &Ellipsoid, segments: u32) -> Self {
        let rings = (segments / 2).max(2);
        let angles: Vec<f32> = (0..=rings).map(|ring| FRAC_PI_2 - PI * ring as f32 / rings as f32).collect();
        let vertex = |direction: Vec3, _| {
            let position = ellipsoid.center + direction * ellipsoid.radii;
            (position, ellipsoid.normal(position))
        };
        lathe(&angles, segments.max(3), vertex)
    }

    /// A capsule of `segments` segments around and half as many from end to end of its two half-spheres (at least 3 and 4).
    ///
    /// Its side is the cone between the spheres' equators: for the slightly different radii of a body that is within a hair
    /// of the tangent cone.
    pub fn capsule(capsule: &Capsule, segments: u32) -> Self {
        let half = (segments / 4).max(2);
        let quarter = |ring: u32| FRAC_PI_2 * ring as f32 / half as f32;
        // The equator twice: once for either end.
        let angles: Vec<f32> = (0..=half).rev().map(quarter).chain((0..=half).map(|ring| -quarter(ring))).collect();
        let axis = (capsule.b - capsule.a).try_normalize().unwrap_or(Vec3::Y);
        let turn = Quat::from_rotation_arc(Vec3::Y, axis);
        let first_end = half as usize;
        lathe(&angles, segments.max(3), |direction, ring| {
            let (center, radius) =
                if ring <= first_end { (capsule.b, capsule.radius_b) } else { (capsule.a, capsule.radius_a) };
            let normal = turn * direction;
            (center + normal * radius, normal)
        })
    }
}

/// Rings of vertices around y at the given latitudes, from the north pole to the south pole, joined by triangles. The
/// vertex is made from the direction and the number of its ring.
fn lathe(latitudes: &[f32], segments: u32, vertex: impl Fn(Vec3, usize) -> (Vec3, Vec3)) -> Mesh {
    let mut mesh = Mesh::default();
    for (ring, latitude) in latitudes.iter().enumerate() {
        for segment in 0..segments {
            let (sin, cos) = (TAU * segment as f32 / segments as f32).sin_cos();
            let direction = Vec3::new(sin * latitude.cos(), latitude.sin(), cos * latitude.cos());
            let (position, normal) = vertex(direction, ring);
            mesh.positions.push(position);
            mesh.normals.push(normal);
        }
    }
    for ring in 1..latitudes.len() as u32 {
        for segment in 0..segments {
            let next = (segment + 1) % segments;
            let [a, b] = [segment, next].map(|s| (ring - 1) * segments + s);
            let [c, d] = [segment, next].map(|s| ring * segments + s);
            mesh.indices.extend([a, c, b, b, c, d]);
        }
    }
    mesh
}
