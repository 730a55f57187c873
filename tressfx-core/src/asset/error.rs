//! What is wrong with a groom file, and where.

use std::fmt;

use thiserror::Error;

/// An error in a groom: in a file that was read, or in an asset that does not fit what it is used for.
#[derive(Debug)]
pub struct AssetError {
    /// The file, as it was named to the reader.
    pub file: String,
    /// Byte offset of the field in the file; `None` where the error is not at a place in a file.
    pub offset: Option<u64>,
    /// Line of a text file, from 1.
    pub line: Option<u64>,
    /// The field, as the format calls it.
    pub field: String,
    /// What is wrong with it. Boxed, to keep results small.
    pub kind: Box<AssetErrorKind>,
}

/// What is wrong with a field.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AssetErrorKind {
    /// The system could not read or write the file.
    #[error("{0}")]
    Io(#[source] std::io::Error),
    /// The content is of none of the known formats.
    #[error("not a groom: neither TressFX text, TressFX 3 or 4 binary, HAIR, nor OBJ lines")]
    UnknownFormat,
    /// The file ends before the field does.
    #[error("needs {needed} bytes, but the file has only {available} from there")]
    Truncated {
        /// Bytes that the field takes.
        needed: u64,
        /// Bytes from the field's offset to the end of the file.
        available: u64,
    },
    /// A number that the format does not allow there.
    #[error("is {value}, but must be {expected}")]
    OutOfRange {
        /// The number.
        value: String,
        /// What would be allowed.
        expected: &'static str,
    },
    /// Text that is not what the format has there.
    #[error("expected {expected}, found {found:?}")]
    Unexpected {
        /// The text found, cut after 32 characters.
        found: String,
        /// What the format has there.
        expected: &'static str,
    },
    /// Two statements of the file contradict each other.
    #[error("is {stated}, but {found} {of}")]
    Mismatch {
        /// What the field says.
        stated: u64,
        /// What there is.
        found: u64,
        /// What was counted.
        of: &'static str,
    },
    /// NaN or infinity in a strand.
    #[error("strand {strand}, vertex {vertex}: {value} is not a finite number")]
    NotFinite {
        /// Strand, from 0.
        strand: usize,
        /// Vertex in the strand, from 0; 0 in a value per strand.
        vertex: usize,
        /// The value.
        value: f32,
    },
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

impl AssetError {
    pub(crate) fn new(file: &str, field: impl Into<String>, kind: AssetErrorKind) -> Self {
        Self { file: file.to_owned(), offset: None, line: None, field: field.into(), kind: Box::new(kind) }
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

impl fmt::Display for AssetError {
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

impl std::error::Error for AssetError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        std::error::Error::source(&*self.kind)
    }
}
