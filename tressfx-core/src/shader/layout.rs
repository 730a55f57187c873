//! Rust structs that the GPU reads, held against the WGSL that reads them.

use naga::TypeInner;

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
/// [`Shader::check_layout`](crate::shader::Shader::check_layout).
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

impl Shader {
    /// Holds a Rust struct against the WGSL struct of the same name: fields, offsets and size.
    ///
    /// # Errors
    /// What differs, in words.
    pub fn check_layout<T: GpuStruct>(&self) -> Result<(), String> {
        let found = self.module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(T::NAME));
        let Some((_, ty)) = found else { return Err(format!("{}: no struct `{}` in the WGSL", self.label, T::NAME)) };
        let TypeInner::Struct { members, span } = &ty.inner else {
            return Err(format!("{}: `{}` is not a struct", self.label, T::NAME));
        };
        let wgsl: Vec<_> =
            members.iter().map(|member| (member.name.as_deref().unwrap_or(""), member.offset as usize)).collect();
        if wgsl != T::FIELDS || *span as usize != size_of::<T>() {
            return Err(format!(
                "{}: `{}` is {wgsl:?}, {span} bytes in WGSL, and {:?}, {} bytes in Rust",
                self.label,
                T::NAME,
                T::FIELDS,
                size_of::<T>()
            ));
        }
        Ok(())
    }
}
