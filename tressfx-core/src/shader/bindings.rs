//! Resources in the order of a shader's slots.

use std::sync::Arc;

use super::{Shader, ShaderSlot};
use crate::id::Resource;

/// What a pass binds: made once by [`Kernel::bind`](crate::backend::Kernel::bind), used in every frame.
///
/// Cheap to clone. Backends may key their own bind objects by the resources.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Bindings(Arc<[Resource]>);

impl Bindings {
    pub(crate) fn new(shader: &Shader, resources: &[(&str, Resource)]) -> Self {
        let label = shader.label;
        for (index, (name, _)) in resources.iter().enumerate() {
            assert!(resources[..index].iter().all(|(other, _)| other != name), "{label}: `{name}` is bound twice");
            assert!(
                shader.slots.iter().any(|slot| slot.name == *name),
                "{label}: the shader has no binding `{name}`, it has {:?}",
                shader.slots.iter().map(|slot| &slot.name).collect::<Vec<_>>()
            );
        }
        let find = |slot: &ShaderSlot| {
            let found = resources.iter().find(|(name, _)| *name == slot.name);
            found.unwrap_or_else(|| panic!("{label}: nothing is bound to `{}`", slot.name)).1
        };
        Self(shader.slots.iter().map(find).collect())
    }

    /// The resources, one for each slot of the shader, in its order.
    pub fn resources(&self) -> &[Resource] {
        &self.0
    }
}
