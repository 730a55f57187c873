//! The bytes that a file names: its own, in URIs, in files beside it.

use std::path::{Component, Path, PathBuf};

use ::gltf::Document;
use ::gltf::buffer::Source;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::gltf::broken;
use crate::{FileError, FileErrorKind};

/// The bytes of all buffers.
///
/// # Errors
/// A buffer that is missing, shorter than it says, or in a file outside of the folder.
pub(super) fn read(
    name: &str,
    document: &Document,
    binary: Option<&[u8]>,
    folder: Option<&Path>,
) -> Result<Vec<Vec<u8>>, FileError> {
    let read = |buffer: ::gltf::Buffer<'_>| {
        let field = format!("buffer {}", buffer.index());
        let bytes = match buffer.source() {
            Source::Bin => binary.ok_or_else(|| broken(name, field.clone(), "the file has no binary chunk"))?.to_vec(),
            Source::Uri(uri) => from_uri(name, &field, uri, folder)?,
        };
        if bytes.len() < buffer.length() {
            let (needed, available) = (buffer.length() as u64, bytes.len() as u64);
            return Err(FileError::new(name, field, FileErrorKind::Truncated { needed, available }));
        }
        Ok(bytes)
    };
    document.buffers().map(read).collect()
}

fn from_uri(name: &str, field: &str, uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, FileError> {
    if let Some(data) = uri.strip_prefix("data:") {
        let Some((_, text)) = data.split_once(";base64,") else {
            return Err(broken(name, field.to_owned(), "a data URI that is not base64"));
        };
        return STANDARD
            .decode(text)
            .map_err(|error| FileError::new(name, field, FileErrorKind::Gltf(error.to_string())));
    }
    let decoded = percent_encoding::percent_decode_str(uri).decode_utf8_lossy().into_owned();
    let path = PathBuf::from(&decoded);
    // A file that somebody sent must not name any other file of the machine.
    if !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err(broken(name, field.to_owned(), "it is in a file outside of the folder"));
    }
    let Some(folder) = folder else {
        return Err(broken(name, field.to_owned(), "it is in another file, and there is no folder to look in"));
    };
    let path = folder.join(path);
    let file = path.display().to_string();
    std::fs::read(&path).map_err(|error| FileError::new(&file, field, FileErrorKind::Io(error)))
}
