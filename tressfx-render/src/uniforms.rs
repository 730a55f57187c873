//! What the shaders are given, field for field: see the WGSL structs of the same names.

use glam::{Mat4, Vec3};
use tressfx_core::gpu_struct;
use tressfx_core::strand_buffers::StrandShape;
use tressfx_core::view::{Pose, View};

use crate::copies::drawn_shape;
use crate::lights::{LightPlace, Lights, MAX_LIGHTS};
use crate::lod::Lod;
use crate::material::Material;
use crate::scattering::variances;
pub use crate::shadow::{OpaqueScenesUniform, OpaqueUniform, ShadowFrameUniform, ShadowUniform};
use crate::strands::StrandInfo;
pub use crate::velocity::MotionUniform;

gpu_struct! {
    /// One light.
    pub struct LightUniform {
        /// Unit direction towards it and 0, or its position and 1.
        pub place: [f32; 4],
        /// Colour, and the distance up to which a point light has it.
        pub color: [f32; 4],
        /// The share that a cone leaves is the square of this vector times the direction towards the light, plus the fourth number.
        pub cone: [f32; 4],
    }
}

gpu_struct! {
    /// From where, and through which lens.
    pub struct LensUniform {
        /// World to the space of the eye, columns.
        pub to_eye: [[f32; 4]; 4],
        /// The pixel that the eye looks at.
        pub center: [f32; 2],
        /// Pixels of a unit length at distance 1, or at any in an orthographic view, to the right and up.
        pub focal: [f32; 2],
        /// Pixels by which a unit length to the right leads up.
        pub skew: f32,
        /// `focal` if it is the same in all directions, else 0.
        pub even_focal: f32,
        /// Distance of the near plane.
        pub near: f32,
        /// By how much the nearness falls with each unit of distance in an orthographic view.
        pub nearness_slope: f32,
        /// A depth `z` stands for the nearness `(z - depth_offset) * depth_scale`.
        pub depth_offset: f32,
        /// See `depth_offset`.
        pub depth_scale: f32,
        /// 1 in a perspective, else 0.
        pub is_perspective: u32,
        /// Nothing.
        pub unused: u32,
    }
}

gpu_struct! {
    /// A view and its lights.
    pub struct ViewUniform {
        /// World to clip, columns.
        pub view_projection: [[f32; 4]; 4],
        /// The lens.
        pub lens: LensUniform,
        /// Position of the eye and 1, or the direction towards it and 0.
        pub eye: [f32; 4],
        /// Light from above.
        pub sky: [f32; 4],
        /// Light from below.
        pub ground: [f32; 4],
        /// Pixels across and down.
        pub size: [u32; 2],
        /// Where in the target they begin.
        pub offset: [u32; 2],
        /// Pixels of the target across and down.
        pub target_size: [u32; 2],
        /// How many of `lights` there are.
        pub light_count: u32,
        /// A bit for each of them that casts shadows.
        pub casting: u32,
        /// Columns and rows of tiles of 8 x 8 pixels in which no hair is, before the first ones in which some may be.
        pub first_tile: [u32; 2],
        /// Nothing.
        pub unused: [u32; 2],
        /// The lights.
        pub lights: [LightUniform; MAX_LIGHTS],
    }
}

gpu_struct! {
    /// What of a section is drawn.
    pub struct LodUniform {
        /// Strands.
        pub strands: u32,
        /// Vertices of each of them.
        pub vertices: u32,
        /// Steps from a drawn vertex to the next one.
        pub step: u32,
        /// Share of its width that the last strand has.
        pub fade: f32,
    }
}

gpu_struct! {
    /// Counts and material of a section.
    pub struct SectionUniform {
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
        /// Radius of a fibre in the unit of the positions, wider where a strand stands for several.
        pub fibre_radius: f32,
        /// What is drawn.
        pub lod: LodUniform,
        /// Share of the width that is left at the tip.
        pub tip_width: f32,
        /// Strength of the diffuse term.
        pub diffuse: f32,
        /// Brightness that differs from strand to strand.
        pub variation: f32,
        /// How much shadows darken.
        pub self_shadow: f32,
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
        /// The share of light that a fibre takes on its way to others.
        pub shadow_alpha: f32,
        /// Variance of the lobe that a fibre mirrors into, where it scatters as glass.
        pub variance: f32,
        /// How much of what the fibres behind it give back is seen.
        pub multiple: f32,
        /// Strands that are counted for shadows at most.
        pub shadow_strands: u32,
        /// Absorption in a radius of the fibre at the root; and what it is as a multiple of the square of the logarithm of a colour.
        pub absorption: [f32; 4],
        /// Absorption at the tip, and 0.
        pub tip_absorption: [f32; 4],
        /// Share of a strand, from the root, that has the colour of the root.
        pub tip_start: f32,
        /// 1 / (1 - tip_start).
        pub tip_scale: f32,
        /// Hue that differs from strand to strand.
        pub hue_variation: f32,
        /// How much of the colours that strands bring along is seen.
        pub own_colors: f32,
        /// Strands that are shaded: copies have the colours of theirs.
        pub shaded_strands: u32,
        /// How far copies are moved along each axis at most, in the unit of the positions.
        pub copy_spread: f32,
        /// Nothing.
        pub unused: [u32; 2],
    }
}

fn with(v: Vec3, w: f32) -> [f32; 4] {
    v.extend(w).to_array()
}

impl LightUniform {
    /// The lights; those beyond [`MAX_LIGHTS`] are left out, and places without one are dark.
    pub(crate) fn all(lights: &Lights) -> [Self; MAX_LIGHTS] {
        let mut all = [Self { place: [0.0; 4], color: [0.0; 4], cone: [0.0; 4] }; MAX_LIGHTS];
        all.iter_mut().zip(&lights.lights).for_each(|(slot, light)| *slot = light.into());
        all
    }
}

impl From<&crate::Light> for LightUniform {
    fn from(light: &crate::Light) -> Self {
        let (place, reach, cone) = match light.place {
            LightPlace::Directional { towards } => (with(towards.normalize_or(Vec3::Y), 0.0), 0.0, None),
            LightPlace::Point { position, reach, cone } => (with(position, 1.0), reach, cone),
        };
        let (ramp, offset) = cone.map_or((Vec3::ZERO, 1.0), |cone| cone.ramp());
        Self { place, color: with(light.color, reach), cone: with(ramp, offset) }
    }
}

impl From<&View> for LensUniform {
    fn from(view: &View) -> Self {
        let lens = view.lens();
        Self {
            to_eye: lens.to_eye.to_cols_array_2d(),
            center: lens.center.to_array(),
            focal: lens.focal.to_array(),
            skew: lens.skew,
            even_focal: lens.even_focal().unwrap_or(0.0),
            near: lens.near,
            nearness_slope: lens.nearness_slope,
            depth_offset: lens.depth_offset,
            depth_scale: lens.depth_scale,
            is_perspective: lens.is_perspective.into(),
            unused: 0,
        }
    }
}

impl ViewUniform {
    /// What the shaders are given for a view. Lights beyond [`MAX_LIGHTS`] are left out.
    pub fn new(view: &View, lights: &Lights) -> Self {
        Self {
            view_projection: view.view_projection().to_cols_array_2d(),
            lens: view.into(),
            eye: view.lens().eye.to_array(),
            sky: with(lights.sky, 0.0),
            ground: with(lights.ground, 0.0),
            size: view.size(),
            offset: view.viewport().offset(),
            target_size: view.viewport().target(),
            light_count: lights.lights.len().min(MAX_LIGHTS) as u32,
            casting: lights.casting(),
            first_tile: [0; 2],
            unused: [0; 2],
            lights: LightUniform::all(lights),
        }
    }
}

impl SectionUniform {
    /// What the shaders are given for a section.
    pub fn new(shape: StrandShape, info: &StrandInfo, material: &Material, pose: &Pose, lod: &Lod) -> Self {
        let Material { primary, secondary, .. } = *material;
        let ([base_color, tip_color], [absorption, tip_absorption]) = (material.colors(), material.absorptions());
        let roughness = material.fibre.map_or(0.0, |fibre| fibre.roughness);
        let matrix: Mat4 = pose.matrix();
        let drawn = drawn_shape(shape, material.copies);
        let of_lod = lod.uniform(drawn);
        // The mean of several strands differs less from that of others.
        let apart = lod.widening(drawn).sqrt();
        Self {
            pose: matrix.to_cols_array_2d(),
            base: with(base_color, material.opacity),
            tip: with(tip_color, material.tip_opacity),
            strands: shape.strands(),
            guides: shape.guides,
            vertices: shape.vertices,
            fibre_radius: info.radius(material) * lod.widening(drawn),
            lod: of_lod,
            tip_width: material.tip_width,
            diffuse: material.diffuse,
            variation: material.variation / apart,
            self_shadow: material.self_shadow,
            primary: [primary.strength, primary.exponent],
            secondary: [secondary.strength, secondary.exponent],
            tilt: material.tilt.to_radians(),
            tilt_variation: material.tilt_variation / apart,
            root_shade: material.root_shade,
            root_extent: material.root_extent,
            shadow_alpha: material.shadow_alpha,
            variance: variances(f64::from(roughness))[0] as f32,
            multiple: material.fibre.map_or(0.0, |fibre| fibre.multiple),
            shadow_strands: lod.shadow_strands(drawn),
            absorption: with(absorption, material.pigmentation()),
            tip_absorption: with(tip_absorption, 0.0),
            tip_start: material.tip_start,
            tip_scale: 1.0 / (1.0 - material.tip_start).max(1e-6),
            hue_variation: material.hue_variation / apart,
            own_colors: 0.0,
            shaded_strands: of_lod.strands.min(shape.strands()),
            copy_spread: material.copy_spread / info.metres_per_unit,
            unused: [0; 2],
        }
    }

    /// The same for strands that bring colours and widths along: the taper is in their widths.
    #[must_use]
    pub fn with_own_look(self, material: &Material, has_color: bool, has_widths: bool) -> Self {
        Self {
            own_colors: if has_color { material.own_colors } else { 0.0 },
            tip_width: if has_widths { 0.0 } else { self.tip_width },
            ..self
        }
    }
}
