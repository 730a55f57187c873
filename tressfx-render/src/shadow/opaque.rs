//! The depth of the opaque scene from a light, as `shadow_opaque` is given it.

use tressfx_core::gpu_struct;

use crate::lights::OpaqueDepth;
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
