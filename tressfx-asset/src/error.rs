//! What is wrong with a groom file, and where.

use std::fmt;

use thiserror::Error;
use tressfx_core::asset::{AssetError, AssetProblem};
use tressfx_core::body::BodyError;

/// An error in a groom file: in one that was read, or in an asset that cannot be written as one.
#[derive(Debug)]
pub struct FileError {
    /// The file, as it was named to the reader.
    pub file: String,
    /// Byte offset of the field in the file; `None` where the error is not at a place in a file.
    pub offset: Option<u64>,
    /// Line of a text file, from 1.
    pub line: Option<u64>,
    /// The field, as the format calls it.
    pub field: String,
    /// What is wrong with it. Boxed, to keep results small.
    pub kind: Box<FileErrorKind>,
}

/// What is wrong with a field.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileErrorKind {
    /// The system could not read or write the file.
    #[error("{0}")]
    Io(#[source] std::io::Error),
    /// The content is of none of the known formats.
    #[error("of no known format: neither TressFX text, TressFX 3 or 4 binary, HAIR, nor OBJ lines")]
    UnknownFormat,
    /// The file ends before the field does.
    #[error("needs {needed} bytes, but the file has only {available} from there")]
    Truncated {
        /// Bytes that the field takes.
        needed: u64,
        /// Bytes from the field's offset to the end of the file.
        available: u64,
    },
    /// A value that the format does not allow there, or that contradicts another.
    #[error(transparent)]
    Value(#[from] AssetProblem),
    /// Text that is not what the format has there.
    #[error("expected {expected}, found {found:?}")]
    Unexpected {
        /// The text found, cut after 32 characters.
        found: String,
        /// What the format has there.
        expected: &'static str,
    },
    /// A mesh whose arrays do not fit each other.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// glTF: the JSON, or what it says.
    #[error("{0}")]
    Gltf(String),
    /// OBJ: the line elements do not make strands.
    #[error("{0}")]
    Topology(&'static str),
    /// 4.x files have one vertex count for all strands.
    #[error("strands have {min} to {max} vertices, but the format has one count for all: resample them first")]
    Ragged {
        /// Fewest vertices of a strand.
        min: u32,
        /// Most vertices of a strand.
        max: u32,
    },
}

impl FileError {
    pub(crate) fn new(file: &str, field: impl Into<String>, kind: impl Into<FileErrorKind>) -> Self {
        Self { file: file.to_owned(), offset: None, line: None, field: field.into(), kind: Box::new(kind.into()) }
    }

    pub(crate) fn at(mut self, offset: usize) -> Self {
        self.offset = Some(offset as u64);
        self
    }

    pub(crate) fn on_line(mut self, line: usize) -> Self {
        self.line = Some(line as u64);
        self
    }
}

impl From<AssetError> for FileError {
    fn from(error: AssetError) -> Self {
        Self::new(&error.asset, error.field, error.problem)
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.field)?;
        match (self.offset, self.line) {
            (Some(offset), Some(line)) => write!(f, " (line {line}, byte {offset})")?,
            (Some(offset), None) => write!(f, " (byte {offset})")?,
            _ => {}
        }
        write!(f, ": {}", self.kind)
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        std::error::Error::source(&*self.kind)
    }
}
