//! What a pass binds, against its shader.

use std::sync::Arc;

use super::{Known, Rule, within};
use crate::backend::{BufferUses, TextureUses};
use crate::id::{BufferId, Resource, TextureId};
use crate::shader::{Binding, Bindings, Shader, ShaderSlot, SlotKind};

impl Known<'_> {
    /// Handles are plain data: one may be put together from two.
    pub(super) fn same_shader(&self, made: &Arc<Shader>, named: &Arc<Shader>) -> Rule {
        match Arc::ptr_eq(made, named) {
            true => Ok(()),
            false => Err(format!("the pipeline was made from another shader, `{}`", made.label)),
        }
    }

    pub(super) fn bindings(&self, shader: &Shader, bindings: &Bindings) -> Rule {
        let all = bindings.all();
        if shader.slots.len() != all.len() {
            return Err(format!("{} of {} bindings", all.len(), shader.slots.len()));
        }
        for (index, (slot, binding)) in shader.slots.iter().zip(all).enumerate() {
            self.binding(slot, binding).map_err(|message| format!("binding `{}`: {message}", slot.name))?;
            let clashes = |other: usize| {
                let same = binding.resource().is_some() && all[other].resource() == binding.resource();
                same && (slot.kind.is_written() || shader.slots[other].kind.is_written())
            };
            if let Some(other) = (0..index).find(|&other| clashes(other)) {
                let other = &shader.slots[other].name;
                return Err(format!("`{other}` and `{}` are the same resource, and it is written", slot.name));
            }
        }
        Ok(())
    }

    fn binding(&self, slot: &ShaderSlot, binding: &Binding) -> Rule {
        match (slot.kind, *binding) {
            (kind, Binding::Buffer { id, offset, bytes }) if kind.is_buffer() => {
                self.bound_buffer(slot, id, offset, bytes)
            }
            (kind, Binding::Texture(id)) if kind.is_texture() => self.bound_texture(kind, id),
            (SlotKind::Sampler, Binding::Sampler(_)) => Ok(()),
            (kind, other) => Err(format!("it is a {kind}, bound is {other:?}")),
        }
    }

    fn bound_buffer(&self, slot: &ShaderSlot, id: BufferId, offset: u64, bytes: Option<u64>) -> Rule {
        let caps = self.all.caps();
        let (uses, most) = match slot.kind {
            SlotKind::Uniform => (BufferUses::UNIFORM, caps.max_uniform_binding_bytes),
            _ => (BufferUses::STORAGE, caps.max_storage_binding_bytes),
        };
        let desc = self.buffer(id, uses)?;
        let bytes = bytes.unwrap_or_else(|| desc.bytes.saturating_sub(offset));
        within(desc, offset, bytes)?;
        if !offset.is_multiple_of(caps.binding_alignment.max(1)) {
            return Err(format!("offset {offset} is not a multiple of {}", caps.binding_alignment));
        }
        if !bytes.is_multiple_of(4) || bytes < slot.min_bytes.max(4) {
            return Err(format!("{bytes} bytes of `{}`, the shader reads {}", desc.label, slot.min_bytes.max(4)));
        }
        if bytes > most {
            return Err(format!("{bytes} bytes of `{}`, the device binds {most}", desc.label));
        }
        Ok(())
    }

    fn bound_texture(&self, kind: SlotKind, id: TextureId) -> Rule {
        let uses = if kind.is_written() { TextureUses::STORAGE } else { TextureUses::SAMPLED };
        let desc = self.texture(id, uses)?;
        let format = desc.format;
        let fits = match kind {
            SlotKind::Texture => !format.is_uint() && !format.is_depth(),
            SlotKind::FilteredTexture => format.is_filterable(),
            SlotKind::UintTexture => format.is_uint(),
            SlotKind::DepthTexture => format.is_depth(),
            SlotKind::StorageTexture(written) | SlotKind::ReadWriteTexture(written) => format == written,
            _ => false,
        };
        if fits { Ok(()) } else { Err(format!("it is a {kind}, `{}` has the format {format:?}", desc.label)) }
    }

    /// Every resource that is written by a shader of a raster pass must be used in no other way in that pass.
    pub(super) fn used_alike(&self, used: &[(Resource, bool)]) -> Rule {
        for (index, (resource, written)) in used.iter().enumerate() {
            if used[..index].iter().any(|(other, also)| other == resource && also != written) {
                return Err(format!("{resource:?} is written and read in the same pass"));
            }
        }
        Ok(())
    }
}
