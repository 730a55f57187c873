//! The depth of the opaque scene from a light, as `shadow_opaque` is given it.

use tressfx_core::gpu_struct;

use crate::lights::{OpaqueDepth, STORED_LIGHTS};
use crate::uniforms::LensUniform;

gpu_struct! {
    /// What a light sees of the opaque scene.
    pub struct OpaqueUniform {
        /// The light's lens.
        pub lens: LensUniform,
        /// Pixels of its view.
        pub size: [u32; 2],
        /// Where they begin in the texture.
        pub offset: [u32; 2],
        /// How much farther than the scene a point may be and still be lit.
        pub bias: f32,
        /// Which light it is.
        pub light: u32,
        /// Nothing.
        pub unused: [u32; 2],
    }
}

gpu_struct! {
    /// What lights see of the opaque scene, in one texture.
    pub struct OpaqueScenesUniform {
        /// What each of them sees.
        pub scenes: [OpaqueUniform; STORED_LIGHTS],
        /// How many of `scenes` there are.
        pub count: u32,
        /// Nothing.
        pub unused_0: u32,
        /// Nothing.
        pub unused_1: u32,
        /// Nothing.
        pub unused_2: u32,
    }
}

impl OpaqueScenesUniform {
    /// What the shader is given for these lights, each with its number.
    pub fn new(lights: &[(usize, OpaqueDepth)]) -> Self {
        let mut made = Self { count: lights.len() as u32, ..bytemuck::Zeroable::zeroed() };
        for (scene, (light, depth)) in made.scenes.iter_mut().zip(lights) {
            *scene = OpaqueUniform::new(depth, *light);
        }
        made
    }
}

impl OpaqueUniform {
    /// What the shader is given for the light of this number.
    pub fn new(scene: &OpaqueDepth, light: usize) -> Self {
        let viewport = scene.view.viewport();
        Self {
            lens: (&scene.view).into(),
            size: viewport.size(),
            offset: viewport.offset(),
            bias: scene.bias,
            light: light as u32,
            unused: [0; 2],
        }
    }
}
