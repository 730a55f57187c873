//! Splitting text files into lines and words, each with its place in the file.

use std::str::FromStr;

use tressfx_core::asset::AssetProblem;

use crate::{FileError, FileErrorKind};

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
const NOTHING: &str = "end of line";

/// The place of a word in a text file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) offset: usize,
    /// From 1.
    pub(crate) line: usize,
}

impl Place {
    pub(crate) fn error(self, name: &str, field: &str, kind: impl Into<FileErrorKind>) -> FileError {
        FileError::new(name, field, kind).at(self.offset).on_line(self.line)
    }
}

/// The lines of a text that are not blank, whether they end with LF or CRLF.
pub(crate) struct Lines<'a> {
    name: &'a str,
    data: &'a [u8],
    next: Place,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(name: &'a str, data: &'a [u8]) -> Self {
        let offset = if data.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        Self { name, data, next: Place { offset, line: 1 } }
    }

    /// The end of what was read.
    pub(crate) fn place(&self) -> Place {
        self.next
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Words<'a>;

    fn next(&mut self) -> Option<Words<'a>> {
        loop {
            let rest = self.data.get(self.next.offset..).filter(|rest| !rest.is_empty())?;
            let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
            let mut words = Words { name: self.name, rest: &rest[..length], place: self.next };
            self.next = Place { offset: self.next.offset + (length + 1).min(rest.len()), line: self.next.line + 1 };
            words.skip_blanks();
            if !words.rest.is_empty() {
                return Some(words);
            }
        }
    }
}

/// The words of a line, separated by blanks or commas.
#[derive(Clone)]
pub(crate) struct Words<'a> {
    name: &'a str,
    rest: &'a [u8],
    place: Place,
}

impl<'a> Words<'a> {
    fn skip_blanks(&mut self) {
        let blanks = self.rest.iter().take_while(|&&byte| is_separator(byte)).count();
        self.advance(blanks);
    }

    fn advance(&mut self, bytes: usize) -> &'a [u8] {
        let (taken, rest) = self.rest.split_at(bytes);
        self.rest = rest;
        self.place.offset += bytes;
        taken
    }

    /// The place of the next word.
    pub(crate) fn place(&self) -> Place {
        self.place
    }

    /// True at the end of the line.
    pub(crate) fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Takes the next word; empty at the end of the line.
    pub(crate) fn word(&mut self) -> &'a [u8] {
        let length = self.rest.iter().take_while(|&&byte| !is_separator(byte)).count();
        let word = self.advance(length);
        self.skip_blanks();
        word
    }

    /// Takes the next word, which must be a given one.
    pub(crate) fn keyword(&mut self, expected: &'static str) -> Result<(), FileError> {
        let place = self.place;
        let word = self.word();
        if word == expected.as_bytes() {
            return Ok(());
        }
        Err(self.unexpected(place, expected, word, expected))
    }

    /// Takes an unsigned number.
    pub(crate) fn u32(&mut self, field: &str) -> Result<u32, FileError> {
        self.number(field, "a whole number from 0 to 2^32 - 1")
    }

    /// Takes a finite number.
    pub(crate) fn f32(&mut self, field: &str) -> Result<f32, FileError> {
        let place = self.place;
        let value = self.number::<f32>(field, "a number")?;
        if value.is_finite() {
            return Ok(value);
        }
        Err(place.error(self.name, field, AssetProblem::out_of_range(value, "a finite number")))
    }

    /// Takes three numbers, finite or not: the caller checks them, and names the vertex in its error.
    pub(crate) fn vector(&mut self, field: &str) -> Result<[f32; 3], FileError> {
        let expected = "a number";
        Ok([self.number(field, expected)?, self.number(field, expected)?, self.number(field, expected)?])
    }

    /// Takes a number of any kind.
    pub(crate) fn number<T: FromStr>(&mut self, field: &str, expected: &'static str) -> Result<T, FileError> {
        let place = self.place;
        let word = self.word();
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| self.unexpected(place, field, word, expected))
    }

    /// Nothing may follow on the line.
    pub(crate) fn end(mut self, field: &str) -> Result<(), FileError> {
        if self.is_empty() {
            return Ok(());
        }
        let place = self.place;
        let word = self.word();
        Err(self.unexpected(place, field, word, NOTHING))
    }

    pub(crate) fn unexpected(&self, place: Place, field: &str, word: &[u8], expected: &'static str) -> FileError {
        let found = match word {
            [] => NOTHING.to_owned(),
            word => String::from_utf8_lossy(word).chars().take(32).collect(),
        };
        place.error(self.name, field, FileErrorKind::Unexpected { found, expected })
    }
}

/// The first word of a text that is not in a comment line (`#`).
pub(crate) fn first_word(data: &[u8]) -> Option<&[u8]> {
    Lines::new("", data).map(|mut line| line.word()).find(|word| !word.starts_with(b"#"))
}

fn is_separator(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == b','
}
