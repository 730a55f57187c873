//! Rust structs that the GPU reads, held against the WGSL that reads them.

use std::collections::HashSet;

use naga::common::wgsl::TypeContext;
use naga::{Handle, StructMember, Type, TypeInner};
use serde::Serialize;

use super::Shader;

/// A `#[repr(C)]` struct with the layout of a WGSL struct of the same name. Made by [`gpu_struct!`](crate::gpu_struct).
pub trait GpuStruct: bytemuck::Pod {
    /// The name in Rust and in WGSL.
    const NAME: &'static str;
    /// Fields and their offsets in bytes.
    const FIELDS: &'static [(&'static str, usize)];
}

/// Defines a struct that the GPU reads.
///
/// Fields stand in the order of the WGSL struct of the same name; a test holds them against each other with
/// `Shader::check_layout` (feature `testing`).
#[macro_export]
macro_rules! gpu_struct {
    ($(#[$doc:meta])* $vis:vis struct $name:ident { $($(#[$field_doc:meta])* pub $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, ::bytemuck::Pod, ::bytemuck::Zeroable)]
        #[repr(C)]
        $vis struct $name { $($(#[$field_doc])* pub $field: $type,)* }

        impl $crate::shader::GpuStruct for $name {
            const NAME: &'static str = stringify!($name);
            const FIELDS: &'static [(&'static str, usize)] =
                &[$((stringify!($field), ::core::mem::offset_of!($name, $field)),)*];
        }
    };
}

/// A struct in a buffer, as the WGSL lays it out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct StructLayout {
    /// Its name.
    pub name: String,
    /// Its size.
    pub bytes: u32,
    /// Its fields, in order.
    pub fields: Vec<FieldLayout>,
}

/// A field of a struct.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FieldLayout {
    /// Its name.
    pub name: String,
    /// The type in the WGSL, such as `vec4<f32>`.
    #[serde(rename = "type")]
    pub type_name: String,
    /// Bytes from the beginning of the struct.
    pub offset: u32,
}

impl Shader {
    /// The structs of its buffers, each after those that it holds.
    pub fn structs(&self) -> Vec<StructLayout> {
        let mut seen = HashSet::new();
        for (_, variable) in
            self.parsed.module.global_variables.iter().filter(|(_, variable)| variable.binding.is_some())
        {
            self.see(variable.ty, &mut seen);
        }
        let types = self.parsed.module.types.iter().filter(|(handle, _)| seen.contains(handle));
        types.filter_map(|(_, ty)| self.layout(ty)).collect()
    }

    fn see(&self, ty: Handle<Type>, seen: &mut HashSet<Handle<Type>>) {
        seen.insert(ty);
        match &self.parsed.module.types[ty].inner {
            TypeInner::Array { base, .. } => self.see(*base, seen),
            TypeInner::Struct { members, .. } => members.iter().for_each(|member| self.see(member.ty, seen)),
            _ => {}
        }
    }

    fn layout(&self, ty: &Type) -> Option<StructLayout> {
        let TypeInner::Struct { members, span } = &ty.inner else { return None };
        let field = |member: &StructMember| FieldLayout {
            name: member.name.clone().unwrap_or_default(),
            type_name: self.parsed.module.to_ctx().type_to_string(member.ty),
            offset: member.offset,
        };
        let name = ty.name.clone().unwrap_or_default();
        Some(StructLayout { name, bytes: *span, fields: members.iter().map(field).collect() })
    }

    /// Holds a Rust struct against the WGSL struct of the same name: fields, offsets and size. For tests.
    ///
    /// # Errors
    /// What differs, in words.
    #[cfg(any(test, feature = "testing"))]
    pub fn check_layout<T: GpuStruct>(&self) -> Result<(), String> {
        let found = self.structs().into_iter().find(|layout| layout.name == T::NAME);
        let Some(layout) = found else { return Err(format!("{}: no struct `{}` in the WGSL", self.label, T::NAME)) };
        let wgsl: Vec<_> = layout.fields.iter().map(|field| (field.name.as_str(), field.offset as usize)).collect();
        if wgsl != T::FIELDS || layout.bytes as usize != size_of::<T>() {
            return Err(format!(
                "{}: `{}` is {wgsl:?}, {} bytes in WGSL, and {:?}, {} bytes in Rust",
                self.label,
                T::NAME,
                layout.bytes,
                T::FIELDS,
                size_of::<T>()
            ));
        }
        Ok(())
    }
}
