//! Reading binary files: every access is checked against the bytes that are there.

use tressfx_core::asset::{AssetProblem, Domain, Values};

use crate::{FileError, FileErrorKind};

/// A binary file and its name.
#[derive(Clone, Copy)]
pub(crate) struct Bytes<'a> {
    pub(crate) name: &'a str,
    pub(crate) data: &'a [u8],
}

impl<'a> Bytes<'a> {
    /// `count` entries of `size` bytes each from `offset`.
    ///
    /// Computed in u64: two 32-bit numbers of a header cannot overflow it by their product with an entry's size.
    pub(crate) fn slice(self, field: &str, offset: usize, count: u64, size: u64) -> Result<&'a [u8], FileError> {
        let tail = self.data.get(offset..).unwrap_or_default();
        let needed = count.saturating_mul(size);
        match usize::try_from(needed).ok().and_then(|needed| tail.get(..needed)) {
            Some(slice) => Ok(slice),
            None => {
                let kind = FileErrorKind::Truncated { needed, available: tail.len() as u64 };
                Err(self.error(field, offset, kind))
            }
        }
    }

    pub(crate) fn u32(self, field: &str, offset: usize) -> Result<u32, FileError> {
        let bytes = self.slice(field, offset, 1, 4)?;
        Ok(words(bytes).next().map_or(0, u32::from_le_bytes))
    }

    /// A finite float.
    pub(crate) fn f32(self, field: &str, offset: usize) -> Result<f32, FileError> {
        self.f32_in(field, offset, Values::Any)
    }

    /// A float that is in range.
    pub(crate) fn f32_in(self, field: &str, offset: usize, range: Values) -> Result<f32, FileError> {
        let value = f32::from_bits(self.u32(field, offset)?);
        range.problem(value).map_or(Ok(value), |problem| Err(self.error(field, offset, problem)))
    }

    /// An array of `count` entries of `N` floats each, which are in range. The domain says which strand and vertex an error names.
    pub(crate) fn floats<const N: usize>(
        self,
        field: &str,
        offset: usize,
        count: usize,
        domain: Domain<'_>,
        range: Values,
    ) -> Result<Vec<[f32; N]>, FileError> {
        let bytes = self.slice(field, offset, count as u64, 4 * N as u64)?;
        let values: Vec<[f32; N]> = bytes.chunks_exact(4 * N).map(entry).collect();
        let flat = values.as_flattened();
        match domain.find_not_finite(flat, N).or_else(|| range.find_beyond(flat)) {
            None => Ok(values),
            Some((index, kind)) => Err(self.error(field, offset + 4 * index, kind)),
        }
    }

    /// An array of `count` unsigned numbers.
    pub(crate) fn u32s(self, field: &str, offset: usize, count: usize) -> Result<Vec<u32>, FileError> {
        Ok(words(self.slice(field, offset, count as u64, 4)?).map(u32::from_le_bytes).collect())
    }

    pub(crate) fn error(self, field: &str, offset: usize, kind: impl Into<FileErrorKind>) -> FileError {
        FileError::new(self.name, field, kind).at(offset)
    }
}

/// An optional array that a header names by its offset, where 0 means that it is absent.
pub(crate) struct OptionalArray {
    /// The name of the header's field.
    pub(crate) field: &'static str,
    /// Where the header keeps the offset.
    pub(crate) at: usize,
    /// The size of the header: no array may start before its end.
    pub(crate) header: usize,
    /// What its values may be.
    pub(crate) range: Values,
}

impl OptionalArray {
    /// The offset of the array, if it is present.
    pub(crate) fn offset(&self, bytes: Bytes<'_>) -> Result<Option<usize>, FileError> {
        match bytes.u32(self.field, self.at)? as usize {
            0 => Ok(None),
            offset if offset < self.header => Err(bytes.error(
                self.field,
                self.at,
                AssetProblem::out_of_range(offset, "0 or an offset behind the header"),
            )),
            offset => Ok(Some(offset)),
        }
    }

    /// The array, if it is present.
    pub(crate) fn floats<const N: usize>(
        &self,
        bytes: Bytes<'_>,
        count: usize,
        domain: Domain<'_>,
    ) -> Result<Option<Vec<[f32; N]>>, FileError> {
        self.offset(bytes)?.map(|offset| bytes.floats(self.field, offset, count, domain, self.range)).transpose()
    }
}

/// `[[x]; n]` as `[x; n]`.
pub(crate) fn scalars(values: Vec<[f32; 1]>) -> Vec<f32> {
    values.into_flattened()
}

fn words(bytes: &[u8]) -> impl Iterator<Item = [u8; 4]> + '_ {
    bytes.as_chunks::<4>().0.iter().copied()
}

fn entry<const N: usize>(bytes: &[u8]) -> [f32; N] {
    let mut words = words(bytes);
    std::array::from_fn(|_| words.next().map_or(0.0, f32::from_le_bytes))
}
