//! Small scenes whose pictures are known.
#![allow(dead_code)] // Each test uses a part.

use std::num::NonZeroU32;

pub(crate) mod light;

use glam::camera::rh;
use glam::{DVec4, Mat4, Vec3};
use tressfx_core::backend::DepthOrder;
use tressfx_core::strand_buffers::StrandShape;
use tressfx_core::view::{Camera, Pose, View};
use tressfx_truth::{Picture, Section, Truth};

/// Strands of one vertex count, of one colour each.
#[derive(Clone, Debug)]
pub(crate) struct Hair {
    pub(crate) shape: StrandShape,
    pub(crate) positions: Vec<[f32; 4]>,
    pub(crate) colors: Vec<[f32; 4]>,
    pub(crate) thickness: Vec<f32>,
    pub(crate) radius: f32,
}

impl Hair {
    /// Strands with their colour and opacity.
    pub(crate) fn new(radius: f32, strands: &[(&[Vec3], [f32; 4])]) -> Self {
        let vertices = strands.first().map_or(2, |(points, _)| points.len());
        let order = || (0..vertices).flat_map(|vertex| strands.iter().map(move |strand| (strand, vertex)));
        Self {
            shape: StrandShape { guides: strands.len() as u32, follows: 0, vertices: vertices as u32 },
            positions: order().map(|((points, _), vertex)| points[vertex].extend(1.0).to_array()).collect(),
            colors: order().map(|((_, color), _)| *color).collect(),
            thickness: order().map(|_| 1.0).collect(),
            radius,
        }
    }

    pub(crate) fn section(&self) -> Section<'_> {
        Section {
            shape: self.shape,
            pose: Pose::IDENTITY,
            positions: &self.positions,
            colors: &self.colors,
            thickness: &self.thickness,
            fibre_radius: self.radius,
            tip_width: 0.0,
        }
    }
}

/// An eye at 0, 0, 4 that looks along -z; the plane z = 0 is 2 high.
pub(crate) fn perspective(size: [u32; 2]) -> View {
    let camera = Camera {
        eye: Vec3::Z * 4.0,
        target: Vec3::ZERO,
        fov: 2.0 * 0.25f32.atan(),
        near: 0.5,
        far: f32::INFINITY,
        depth: DepthOrder::Reverse,
    };
    camera.view(size).unwrap()
}

/// The square from -1 to 1, seen along -z from z = 4 on.
pub(crate) fn orthographic(size: [u32; 2]) -> View {
    let view = rh::view::look_to_mat4(Vec3::Z * 4.0, Vec3::NEG_Z, Vec3::Y);
    let projection: Mat4 = rh::proj::directx::orthographic(-1.0, 1.0, -1.0, 1.0, 0.0, 8.0);
    View::new(view, projection, DepthOrder::Standard, size).unwrap()
}

pub(crate) fn samples(count: u32) -> NonZeroU32 {
    NonZeroU32::new(count).unwrap()
}

/// Renders without a scene.
pub(crate) fn render(view: &View, hair: &[&Hair], count: u32) -> Picture {
    let sections: Vec<_> = hair.iter().map(|hair| hair.section()).collect();
    Truth::new(view, &sections, None).unwrap().render(samples(count), &|_| ())
}

/// The pixel at a column and a row.
pub(crate) fn pixel(picture: &Picture, x: u32, y: u32) -> DVec4 {
    picture.pixels()[(y * picture.size()[0] + x) as usize]
}

/// Premultiplied.
pub(crate) fn premultiplied([r, g, b, a]: [f32; 4]) -> DVec4 {
    DVec4::new((r * a).into(), (g * a).into(), (b * a).into(), a.into())
}

/// `b` behind `a`, both premultiplied.
pub(crate) fn over(a: DVec4, b: DVec4) -> DVec4 {
    a + (1.0 - a.w) * b
}

/// Mean of alpha over all pixels.
pub(crate) fn mean_alpha(picture: &Picture) -> f64 {
    picture.pixels().iter().map(|pixel| pixel.w).sum::<f64>() / picture.pixels().len() as f64
}

#[track_caller]
pub(crate) fn assert_near(found: DVec4, expected: DVec4) {
    assert!((found - expected).abs().max_element() < 1e-6, "{found} is not {expected}");
}
