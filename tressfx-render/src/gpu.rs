//! What the shaders are given, field for field: see the WGSL structs of the same names.

use glam::{Mat4, Vec3};
use tressfx_core::gpu_struct;
use tressfx_core::strand_buffers::StrandShape;
use tressfx_core::view::{Pose, View};

use crate::lights::{LightPlace, Lights, MAX_LIGHTS};
use crate::material::Material;
use crate::section::StrandInfo;

gpu_struct! {
    /// One light.
    pub struct Light {
        /// Unit direction towards it and 0, or its position and 1.
        pub place: [f32; 4],
        /// Colour, and the distance up to which a point light has it.
        pub color: [f32; 4],
    }
}

gpu_struct! {
    /// The camera and the lights.
    pub struct Frame {
        /// World to view, columns.
        pub view: [[f32; 4]; 4],
        /// World to clip, columns.
        pub view_projection: [[f32; 4]; 4],
        /// Position of the eye.
        pub eye: [f32; 4],
        /// Light from above.
        pub sky: [f32; 4],
        /// Light from below.
        pub ground: [f32; 4],
        /// Pixels across and down.
        pub size: [u32; 2],
        /// Pixels of a unit length at distance 1.
        pub focal: f32,
        /// Distance of the near plane.
        pub near: f32,
        /// A depth `z` stands for the distance `w` with `1 / w = (z - depth_offset) * depth_scale`.
        pub depth_offset: f32,
        /// See `depth_offset`.
        pub depth_scale: f32,
        /// How many of `lights` there are.
        pub light_count: u32,
        /// Fragments that the pool holds.
        pub node_capacity: u32,
        /// The lights.
        pub lights: [Light; MAX_LIGHTS],
    }
}

gpu_struct! {
    /// Counts and material of a section.
    pub struct Section {
        /// Where the section is moved to, columns.
        pub pose: [[f32; 4]; 4],
        /// Colour and opacity at the root.
        pub base: [f32; 4],
        /// Colour and opacity at the tip.
        pub tip: [f32; 4],
        /// Strands, guides and follow strands.
        pub strands: u32,
        /// Guides.
        pub guides: u32,
        /// Vertices of a strand.
        pub vertices: u32,
        /// Radius of a fibre in the unit of the positions.
        pub fibre_radius: f32,
        /// Share of the width that is left at the tip.
        pub tip_width: f32,
        /// Strength of the diffuse term.
        pub diffuse: f32,
        /// Brightness that differs from strand to strand.
        pub variation: f32,
        /// How much the shadow of the groom on itself darkens.
        pub form: f32,
        /// Strength and exponent of the white highlight.
        pub primary: [f32; 2],
        /// Strength and exponent of the coloured highlight.
        pub secondary: [f32; 2],
        /// Tilt of the cuticle in radians.
        pub tilt: f32,
        /// Tilt that differs from strand to strand.
        pub tilt_variation: f32,
        /// Darkness at the root.
        pub root_shade: f32,
        /// Where it ends.
        pub root_extent: f32,
    }
}

fn with(v: Vec3, w: f32) -> [f32; 4] {
    v.extend(w).to_array()
}

impl From<&crate::Light> for Light {
    fn from(light: &crate::Light) -> Self {
        let (place, reach) = match light.place {
            LightPlace::Directional { towards } => (with(towards.normalize_or(Vec3::Y), 0.0), 0.0),
            LightPlace::Point { position, reach } => (with(position, 1.0), reach),
        };
        Self { place, color: with(light.color, reach) }
    }
}

impl Frame {
    /// What the shaders are given for a view.
    ///
    /// # Panics
    /// If there are more than [`MAX_LIGHTS`] lights.
    pub fn new(view: &View, lights: &Lights, node_capacity: u32) -> Self {
        let count = lights.lights.len();
        assert!(count <= MAX_LIGHTS, "{count} lights, a frame can have {MAX_LIGHTS}");
        let mut array = [Light { place: [0.0; 4], color: [0.0; 4] }; MAX_LIGHTS];
        array.iter_mut().zip(&lights.lights).for_each(|(slot, light)| *slot = light.into());
        let projection = view.projection_matrix();
        Self {
            view: view.view_matrix().to_cols_array_2d(),
            view_projection: view.view_projection().to_cols_array_2d(),
            eye: with(view.eye, 1.0),
            sky: with(lights.sky, 0.0),
            ground: with(lights.ground, 0.0),
            size: view.size,
            focal: 1.0 / view.pixel_angle(),
            near: view.near,
            // z / w = -projection[2][2] + projection[3][2] / w, since w is the distance and z is linear in it.
            depth_offset: -projection.z_axis.z,
            depth_scale: 1.0 / projection.w_axis.z,
            light_count: count as u32,
            node_capacity,
            lights: array,
        }
    }
}

impl Section {
    /// What the shaders are given for a section.
    pub fn new(shape: StrandShape, info: &StrandInfo, material: &Material, pose: &Pose) -> Self {
        let Material { base_color: base, tip_color: tip, primary, secondary, .. } = *material;
        let matrix: Mat4 = pose.matrix();
        Self {
            pose: matrix.to_cols_array_2d(),
            base: [base[0], base[1], base[2], material.opacity],
            tip: [tip[0], tip[1], tip[2], material.tip_opacity],
            strands: shape.strands(),
            guides: shape.guides,
            vertices: shape.vertices,
            fibre_radius: info.radius(material),
            tip_width: material.tip_width,
            diffuse: material.diffuse,
            variation: material.variation,
            form: material.form,
            primary: [primary.strength, primary.exponent],
            secondary: [secondary.strength, secondary.exponent],
            tilt: material.tilt.to_radians(),
            tilt_variation: material.tilt_variation,
            root_shade: material.root_shade,
            root_extent: material.root_extent,
        }
    }
}
