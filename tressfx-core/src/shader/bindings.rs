//! Resources in the order of a shader's slots.

use std::sync::Arc;

use super::Shader;
use crate::error::{Error, Result};
use crate::id::{BufferId, Resource, TextureId};

/// One of the two samplers that every device has. Both clamp coordinates to the texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampler {
    /// Between the four nearest texels.
    Linear,
    /// The nearest texel.
    Nearest,
}

/// What is bound to one slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Binding {
    /// A buffer, or a part of it.
    Buffer {
        /// Which one.
        id: BufferId,
        /// From this byte: a multiple of [`Caps::binding_alignment`](crate::backend::Caps::binding_alignment).
        offset: u64,
        /// So many bytes, a multiple of 4; `None`: up to its end.
        bytes: Option<u64>,
    },
    /// A texture.
    Texture(TextureId),
    /// A sampler.
    Sampler(Sampler),
}

impl BufferId {
    /// A part of the buffer, to be bound: `bytes` bytes from byte `offset` on, which is a multiple of
    /// [`Caps::binding_alignment`](crate::backend::Caps::binding_alignment).
    pub fn range(self, offset: u64, bytes: u64) -> Binding {
        Binding::Buffer { id: self, offset, bytes: Some(bytes) }
    }
}

impl Binding {
    /// What holds its memory; samplers hold none.
    pub fn resource(&self) -> Option<Resource> {
        match *self {
            Self::Buffer { id, .. } => Some(Resource::Buffer(id)),
            Self::Texture(id) => Some(Resource::Texture(id)),
            Self::Sampler(_) => None,
        }
    }
}

impl From<BufferId> for Binding {
    fn from(id: BufferId) -> Self {
        Self::Buffer { id, offset: 0, bytes: None }
    }
}

impl From<TextureId> for Binding {
    fn from(id: TextureId) -> Self {
        Self::Texture(id)
    }
}

impl From<Resource> for Binding {
    fn from(resource: Resource) -> Self {
        match resource {
            Resource::Buffer(id) => id.into(),
            Resource::Texture(id) => id.into(),
        }
    }
}

impl From<Sampler> for Binding {
    fn from(sampler: Sampler) -> Self {
        Self::Sampler(sampler)
    }
}

/// What a pass binds: made once by [`Kernel::bind`](crate::shader::Kernel::bind) or
/// [`RasterPipeline::bind`](crate::shader::RasterPipeline::bind), used in every frame.
///
/// Cheap to clone. Backends may key their own bind objects by it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Bindings(Arc<[Binding]>);

impl Bindings {
    /// As they stand: one for each slot of a shader, in its order. A backend holds them against the shader.
    pub fn new(bindings: &[Binding]) -> Self {
        Self(bindings.into())
    }

    pub(super) fn named(shader: &Shader, bindings: &[(&str, Binding)]) -> Result<Self> {
        let refuse = |message| Err(Error::rule(shader.label, message));
        for (index, (name, _)) in bindings.iter().enumerate() {
            if bindings[..index].iter().any(|(other, _)| other == name) {
                return refuse(format!("`{name}` is bound twice"));
            }
            if shader.slots.iter().all(|slot| slot.name != *name) {
                let has: Vec<_> = shader.slots.iter().map(|slot| &slot.name).collect();
                return refuse(format!("the shader has no binding `{name}`, it has {has:?}"));
            }
        }
        let mut all = Vec::with_capacity(shader.slots.len());
        for slot in &shader.slots {
            match bindings.iter().find(|(name, _)| *name == slot.name) {
                Some((_, binding)) => all.push(*binding),
                None => return refuse(format!("nothing is bound to `{}`", slot.name)),
            }
        }
        Ok(Self(all.into()))
    }

    /// One for each slot of the shader, in its order.
    pub fn all(&self) -> &[Binding] {
        &self.0
    }

    /// The buffers and textures, some of them more than once.
    pub fn resources(&self) -> impl Iterator<Item = Resource> {
        self.0.iter().filter_map(Binding::resource)
    }

    /// Whether a resource is among them.
    pub fn names(&self, resource: Resource) -> bool {
        self.resources().any(|other| other == resource)
    }
}
