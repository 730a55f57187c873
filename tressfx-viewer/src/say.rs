//! What the program says on its standard output.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

/// Writes a line. That nobody reads on, as behind `head`, is no error.
///
/// # Errors
/// If it cannot be written otherwise, such as to a full disk.
pub(crate) fn say(line: impl Display) -> io::Result<()> {
    match writeln!(io::stdout(), "{line}") {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done,
    }
}
