//! The frames of a view: from where its lights and the sky see the hair.

use glam::{Mat3, Mat4, Vec3};
use tressfx_core::gpu_struct;

use super::ShadowDesc;
use crate::lights::{Light, LightPlace, Lights, MAX_LIGHTS, STORED_LIGHTS};
use crate::strands::SectionDraw;
use crate::uniforms::LightUniform;

/// The sky's frame and those of lights.
const FRAMES: usize = STORED_LIGHTS + 1;

/// Kinds of frames, as in `frames.wgsl`.
const SKY: u32 = 0;
const DIRECTIONAL: u32 = 1;
const POINT: u32 = 2;

/// A light that nothing shades, and one that is taken from what arrives from everywhere.
const OPEN: u32 = u32::MAX;
const BY_SKY: u32 = 0;

/// A point light has a frame of its own if it is farther from the middle of the hair than so many times the radius of its sphere.
const OUTSIDE: f32 = 1.25;

gpu_struct! {
    /// From where hair is seen.
    pub struct ShadowFrameUniform {
        /// World to the frame, columns; the third axis is the way of the light.
        pub axes: [[f32; 4]; 4],
        /// Cells along each axis.
        pub size: [u32; 3],
        /// The first of them among those of all frames.
        pub first: u32,
        /// 0 the sky, 1 a directional light, 2 a point light.
        pub kind: u32,
        /// Nearer to a point light than this nothing is told apart.
        pub nearest: f32,
        /// 1 where skin is behind roots, 0 where there is none, or the opaque scene is known.
        pub has_skin: u32,
        /// Nothing.
        pub unused: u32,
    }
}

gpu_struct! {
    /// The frames of a view.
    pub struct ShadowUniform {
        /// The lights.
        pub lights: [LightUniform; MAX_LIGHTS],
        /// The sky's, then those of lights.
        pub frames: [ShadowFrameUniform; FRAMES],
        /// The frame of each light; 0 where it is taken from the sky's, all bits where nothing shades it.
        pub of_light: [[u32; 4]; MAX_LIGHTS / 4],
        /// The first frame in use.
        pub first: u32,
        /// One more than the last.
        pub end: u32,
        /// Strands of a section that are counted at most.
        pub samples: u32,
        /// The largest radius of a fibre.
        pub radius: f32,
    }
}

/// Cells of all frames.
pub(super) fn cells_of_all(desc: &ShadowDesc) -> u64 {
    u64::from(desc.cells).pow(3) + u64::from(desc.lights) * cells_of_light(desc)
}

fn cells_of_light(desc: &ShadowDesc) -> u64 {
    u64::from(desc.texels) * u64::from(desc.texels) * u64::from(desc.layers)
}

impl ShadowUniform {
    /// The frames of the lights that cast, as many as there is room for.
    pub fn new(desc: &ShadowDesc, lights: &Lights, draws: &[SectionDraw]) -> Self {
        let desc = &desc.coarser(draws);
        let none = frame(desc, 0, Mat4::IDENTITY, SKY, 0.0);
        let mut uniform = Self {
            lights: LightUniform::all(lights),
            frames: [none; FRAMES],
            of_light: [[OPEN; 4]; MAX_LIGHTS / 4],
            first: 0,
            end: 1,
            samples: desc.samples,
            radius: draws.iter().map(|draw| draw.strands.radius(draw.material)).fold(0.0, f32::max),
        };
        if draws.is_empty() {
            return Self { first: 1, ..uniform };
        }
        let sphere = sphere_of(draws);
        for (index, light) in lights.lights.iter().take(MAX_LIGHTS).enumerate().filter(|(_, light)| light.casts) {
            let has_room = index < STORED_LIGHTS && uniform.end <= desc.lights;
            let seen = axes_of(light, sphere).filter(|_| has_room);
            uniform.of_light[index / 4][index % 4] = match seen {
                None => BY_SKY,
                Some((axes, kind, nearest)) => {
                    let seen = frame(desc, uniform.end, axes, kind, nearest);
                    let has_skin = u32::from(desc.skin && light.opaque.is_none());
                    uniform.frames[uniform.end as usize] = ShadowFrameUniform { has_skin, ..seen };
                    uniform.end += 1;
                    uniform.end - 1
                }
            };
        }
        let is_dark = lights.sky == Vec3::ZERO && lights.ground == Vec3::ZERO;
        let asks_the_sky = uniform.of_light.as_flattened().contains(&BY_SKY);
        uniform.first = u32::from(is_dark && !asks_the_sky);
        uniform
    }
}

fn frame(desc: &ShadowDesc, index: u32, axes: Mat4, kind: u32, nearest: f32) -> ShadowFrameUniform {
    let (size, first) = match index.checked_sub(1) {
        None => ([desc.cells; 3], 0),
        Some(before) => {
            let first = u64::from(desc.cells).pow(3) + u64::from(before) * cells_of_light(desc);
            ([desc.texels, desc.texels, desc.layers], first as u32)
        }
    };
    ShadowFrameUniform {
        axes: axes.to_cols_array_2d(),
        size,
        first,
        kind,
        nearest,
        has_skin: u32::from(desc.skin),
        unused: 0,
    }
}

/// The middle of all hair in its rest pose, and the distance of what is farthest from it.
fn sphere_of(draws: &[SectionDraw]) -> (Vec3, f32) {
    let placed = |draw: &SectionDraw| (draw.pose.transform(draw.sphere().0), draw.sphere().1);
    let spheres = || draws.iter().map(placed);
    let middle = spheres().map(|(middle, _)| middle).sum::<Vec3>() / draws.len().max(1) as f32;
    (middle, spheres().map(|(at, radius)| at.distance(middle) + radius).fold(0.0, f32::max))
}

/// World to the axes of a light, the kind of its frame, and the smallest distance from it that is told apart; none for a light among the hair,
/// or in no direction.
fn axes_of(light: &Light, (middle, radius): (Vec3, f32)) -> Option<(Mat4, u32, f32)> {
    match light.place {
        LightPlace::Directional { towards } => {
            let way = (-towards).try_normalize()?;
            Some((Mat4::from_mat3(along(way)), DIRECTIONAL, 0.0))
        }
        LightPlace::Point { position, .. } => {
            let distance = position.distance(middle);
            let way = (middle - position).try_normalize().filter(|_| distance > OUTSIDE * radius)?;
            let axes = Mat4::from_mat3(along(way)) * Mat4::from_translation(-position);
            axes.is_finite().then_some((axes, POINT, (distance - OUTSIDE * radius).max(0.02 * distance)))
        }
    }
}

/// World to axes of which the third is `way`.
fn along(way: Vec3) -> Mat3 {
    let (x, y) = way.any_orthonormal_pair();
    Mat3::from_cols(x, y, way).transpose()
}
