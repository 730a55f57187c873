//! Uniforms that change between the passes of a list.

use std::marker::PhantomData;

use bytemuck::NoUninit;

use crate::backend::{Backend, BufferDesc};
use crate::error::{Label, Result};
use crate::id::BufferId;
use crate::pass::PassList;
use crate::shader::Binding;

/// Structs in one uniform buffer: they are uploaded together, and each pass binds its own.
#[derive(Debug)]
pub struct UniformArray<T> {
    buffer: BufferId,
    /// From struct to struct, in bytes: as ranges of bindings are aligned.
    stride: u64,
    count: u64,
    holds: PhantomData<fn() -> T>,
}

impl<T: NoUninit> UniformArray<T> {
    const BYTES: u64 = size_of::<T>() as u64;

    /// Room for `count` structs.
    ///
    /// # Errors
    /// What the backend says when it cannot make a buffer of that size.
    pub fn new(backend: &mut dyn Backend, label: Label, count: usize) -> Result<Self> {
        let stride = Self::BYTES.next_multiple_of(backend.caps().binding_alignment);
        let buffer = backend.create_buffer(&BufferDesc::uniform(label, stride * count as u64))?;
        Ok(Self { buffer, stride, count: count as u64, holds: PhantomData })
    }

    /// Bytes of the buffer.
    pub fn bytes(&self) -> u64 {
        self.stride * self.count
    }

    /// What a pass binds for the struct at `index`.
    pub fn binding(&self, index: usize) -> Binding {
        self.buffer.range(index as u64 * self.stride, Self::BYTES)
    }

    /// Frees the buffer.
    pub fn destroy(self, backend: &mut dyn Backend) {
        backend.destroy(self.buffer.into());
    }

    /// Uploads structs to the places from `first` on.
    pub fn upload(&self, list: &mut PassList, first: usize, structs: &[T]) {
        let stride = self.stride as usize;
        let mut bytes = vec![0u8; stride * structs.len()];
        for (place, one) in bytes.chunks_exact_mut(stride).zip(structs) {
            place[..size_of::<T>()].copy_from_slice(bytemuck::bytes_of(one));
        }
        list.upload(self.buffer, self.stride * first as u64, &bytes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::null::NullBackend;
    use crate::pass::Command;

    #[test]
    fn structs_lie_where_passes_bind_them() {
        let mut backend = NullBackend::default();
        let array = UniformArray::<[u32; 3]>::new(&mut backend, "test.array", 4).unwrap();
        let mut list = PassList::new();
        array.upload(&mut list, 2, &[[1, 2, 3], [4, 5, 6]]);
        let [Command::Upload { dst, offset, data }] = list.commands() else { panic!("{list:?}") };
        assert_eq!((*offset, data.len()), (2 * 256, 2 * 256));
        assert_eq!(array.binding(3), dst.range(3 * 256, 12));
        assert_eq!(list.bytes()[256..268], *bytemuck::bytes_of(&[4u32, 5, 6]));
    }
}
