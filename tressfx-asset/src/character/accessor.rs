//! Arrays of a file, held to the bytes that are there.

use ::gltf::Accessor;
use ::gltf::accessor::DataType;
use ::gltf::accessor::sparse::IndexType;
use ::gltf::buffer::View;

use super::gltf::{broken, unsound};
use crate::{FileError, FileErrorKind};

/// The arrays of a file.
#[derive(Clone, Copy)]
pub(super) struct Arrays<'a> {
    pub(super) name: &'a str,
    pub(super) buffers: &'a [Vec<u8>],
}

impl Arrays<'_> {
    /// Entries of `N` finite numbers each; whole numbers that stand for shares become those.
    ///
    /// `expected` is how many there must be, where that is known.
    pub(super) fn floats<const N: usize>(
        self,
        accessor: &Accessor<'_>,
        field: &str,
        expected: Option<usize>,
    ) -> Result<Vec<[f32; N]>, FileError> {
        let normalized = accessor.normalized();
        let number = |bytes: &[u8], kind| match (kind, normalized) {
            (DataType::F32, _) => Some(f32::from_le_bytes(array(bytes))),
            (DataType::U8, true) => Some(f32::from(bytes[0]) / 255.0),
            (DataType::U16, true) => Some(f32::from(u16::from_le_bytes(array(bytes))) / 65535.0),
            (DataType::I8, true) => Some((f32::from(bytes[0] as i8) / 127.0).max(-1.0)),
            (DataType::I16, true) => Some((f32::from(i16::from_le_bytes(array(bytes))) / 32767.0).max(-1.0)),
            _ => None,
        };
        let entries: Vec<[f32; N]> = self.entries(accessor, field, expected, number)?;
        match entries.iter().position(|entry| entry.iter().any(|value| !value.is_finite())) {
            Some(entry) => Err(unsound(self.name, format!("{field}, entry {entry}"))),
            None => Ok(entries),
        }
    }

    /// Entries of `N` unsigned whole numbers each.
    pub(super) fn integers<const N: usize>(
        self,
        accessor: &Accessor<'_>,
        field: &str,
        expected: Option<usize>,
    ) -> Result<Vec<[u32; N]>, FileError> {
        self.entries(accessor, field, expected, |bytes, kind| match kind {
            DataType::U8 => Some(u32::from(bytes[0])),
            DataType::U16 => Some(u32::from(u16::from_le_bytes(array(bytes)))),
            DataType::U32 => Some(u32::from_le_bytes(array(bytes))),
            _ => None,
        })
    }

    fn entries<T: Copy + Default, const N: usize>(
        self,
        accessor: &Accessor<'_>,
        field: &str,
        expected: Option<usize>,
        number: impl Fn(&[u8], DataType) -> Option<T>,
    ) -> Result<Vec<[T; N]>, FileError> {
        let (count, kind) = (accessor.count(), accessor.data_type());
        let wrong = |what| Err(broken(self.name, format!("{field} (accessor {})", accessor.index()), what));
        if accessor.dimensions().multiplicity() != N {
            return wrong("its entries have another number of components");
        }
        if count == 0 || expected.is_some_and(|expected| expected != count) {
            return wrong("it has another number of entries than it must");
        }
        let size = kind.size();
        let decode = |bytes: &[u8]| {
            let mut entry = [T::default(); N];
            for (part, bytes) in entry.iter_mut().zip(bytes.chunks_exact(size)) {
                *part = number(bytes, kind)?;
            }
            Some(entry)
        };
        let mut entries = match accessor.view() {
            Some(view) => self.strided(&view, accessor.offset(), count, size * N, field)?.map(decode).collect(),
            // Nothing in the file stands for so many zeros, so another array has to.
            None if expected.is_none() => return wrong("it has no bytes"),
            None => Some(vec![[T::default(); N]; count]),
        };
        if let (Some(entries), Some(sparse)) = (&mut entries, accessor.sparse()) {
            let (places, values) = (sparse.indices(), sparse.values());
            let place_size = places.index_type().size();
            let some = sparse.count();
            let (place_view, value_view) = (places.view(), values.view());
            let places_at = self.strided(&place_view, places.offset(), some, place_size, field)?;
            let values_at = self.strided(&value_view, values.offset(), some, size * N, field)?;
            for (place, value) in places_at.zip(values_at) {
                let place = match places.index_type() {
                    IndexType::U8 => u32::from(place[0]),
                    IndexType::U16 => u32::from(u16::from_le_bytes(array(place))),
                    IndexType::U32 => u32::from_le_bytes(array(place)),
                };
                match (entries.get_mut(place as usize), decode(value)) {
                    (Some(entry), Some(value)) => *entry = value,
                    _ => {
                        return wrong("a sparse entry is outside of the array, or of a type that is not allowed there");
                    }
                }
            }
        }
        entries.map_or_else(|| wrong("its components have a type that is not allowed there"), Ok)
    }

    /// `count` pieces of a view, each of at least `size` bytes.
    fn strided(
        &self,
        view: &View<'_>,
        offset: usize,
        count: usize,
        size: usize,
        field: &str,
    ) -> Result<std::slice::Chunks<'_, u8>, FileError> {
        let stride = view.stride().unwrap_or(size);
        if stride < size {
            return Err(broken(self.name, field.to_owned(), "its entries overlap"));
        }
        let truncated = |needed: u64, available: usize| {
            let available = available as u64;
            FileError::new(self.name, field, FileErrorKind::Truncated { needed, available })
        };
        let buffer = self.buffers.get(view.buffer().index()).map(Vec::as_slice).unwrap_or_default();
        let end = view.offset().checked_add(view.length());
        let bytes = end.and_then(|end| buffer.get(view.offset()..end));
        let bytes = bytes.ok_or_else(|| truncated(end.unwrap_or(usize::MAX) as u64, buffer.len()))?;
        let bytes = bytes.get(offset..).unwrap_or_default();
        let needed = match count.checked_sub(1) {
            Some(others) => (others as u64).saturating_mul(stride as u64).saturating_add(size as u64),
            None => 0,
        };
        let pieces = usize::try_from(needed).ok().and_then(|needed| bytes.get(..needed));
        Ok(pieces.ok_or_else(|| truncated(needed, bytes.len()))?.chunks(stride))
    }
}

/// The first bytes; zeros where there are none.
fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    bytes.first_chunk().copied().unwrap_or([0; N])
}
