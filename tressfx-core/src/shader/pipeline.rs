//! Compiled pipelines, as passes name them.

use std::fmt;
use std::sync::Arc;

use super::{Binding, Bindings, Shader};
use crate::error::{Label, Result};
use crate::id::PipelineId;

macro_rules! pipeline {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone)]
        pub struct $name {
            /// The backend's pipeline.
            pub pipeline: PipelineId,
            /// What it was compiled from: label, features and bindings.
            pub shader: Arc<Shader>,
        }

        impl $name {
            /// Its label.
            pub fn label(&self) -> Label {
                self.shader.label
            }

            /// Puts bindings in the order of the shader's slots.
            ///
            /// # Errors
            /// [`Error::Rule`](crate::Error::Rule) if a name of the shader is missing, named twice or unknown.
            pub fn bind(&self, bindings: &[(&str, Binding)]) -> Result<Bindings> {
                Bindings::named(&self.shader, bindings)
            }
        }

        impl PartialEq for $name {
            fn eq(&self, other: &Self) -> bool {
                self.pipeline == other.pipeline
            }
        }

        impl fmt::Debug for $name {
            fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
                write!(out, "{}", self.shader.label)?;
                if self.shader.features.is_empty() { Ok(()) } else { write!(out, " [{}]", self.shader.features) }
            }
        }
    };
}

pipeline! {
    /// A compute pipeline together with the shader that it was compiled from.
    Kernel
}

pipeline! {
    /// A raster pipeline together with the shader that it was compiled from.
    RasterPipeline
}
