//! Atomic writing of files, and the standard streams of a program.
//!
//! Where a program expects the name of a file, `-` stands for standard input or output. A file of
//! that name is given as `./-`.

mod conflict;
mod file;
mod path;
mod temporary;

use std::io::{self, IsTerminal, Write};
use std::path::Path;

use crate::format::printable;

pub use conflict::{FilesInUse, TakenError, check_outputs};
pub use file::{WriteError, check_folder, check_writable, write_file, write_json};
pub use path::resolved;
pub use temporary::abandon;

/// Whether a path is `-`, which stands for standard input or output.
pub fn is_standard_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Prints to standard output. A closed pipe (`| head`) is not an error.
///
/// # Errors
///
/// Standard output cannot be written.
pub fn print(bytes: &[u8]) -> io::Result<()> {
    send(&mut io::stdout().lock(), bytes)
}

/// Prints a text to standard output, without characters that control a terminal.
///
/// # Errors
///
/// Standard output cannot be written.
pub fn print_text(text: &str) -> io::Result<()> {
    print(printable(text).as_bytes())
}

/// Prints a text to standard error, beside data on standard output. A failure to do so is ignored.
pub fn print_note(text: &str) {
    let _ = write!(io::stderr(), "{}", printable(text));
}

/// Prints an error message to standard error. A failure to do so is ignored.
pub fn print_error(message: &str) {
    let name = if io::stderr().is_terminal() {
        "\x1b[1;31merror:\x1b[0m"
    } else {
        "error:"
    };
    let _ = writeln!(io::stderr(), "{name} {}", printable(message));
}

/// Writes to a stream in one piece, once `write` has succeeded.
fn write_stream(
    stream: &mut dyn Write,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut bytes = Vec::new();
    write(&mut bytes)?;
    send(stream, &bytes)
}

/// Writes bytes to a stream. A closed pipe is not an error.
fn send(stream: &mut dyn Write, bytes: &[u8]) -> io::Result<()> {
    match stream.write_all(bytes).and_then(|()| stream.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stream that fails.
    struct Failing(io::ErrorKind);

    impl Write for Failing {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(self.0.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_stream_is_written_in_one_piece_or_not_at_all() {
        let mut stream = Vec::new();
        write_stream(&mut stream, |w| w.write_all(b"whole")).unwrap();
        let failed = write_stream(&mut stream, |w| {
            w.write_all(b"half")?;
            Err(io::Error::other("no more"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "no more");
        assert_eq!(stream, b"whole");
    }

    #[test]
    fn a_closed_pipe_is_no_error_and_a_full_device_is_one() {
        let write = |kind| write_stream(&mut Failing(kind), |w| w.write_all(b"text"));
        assert!(write(io::ErrorKind::BrokenPipe).is_ok());
        assert!(write(io::ErrorKind::StorageFull).is_err());
    }

    #[test]
    fn a_hyphen_alone_is_a_standard_stream() {
        assert!(is_standard_stream(Path::new("-")));
        for file in ["./-", "--", "-x", ""] {
            assert!(!is_standard_stream(Path::new(file)));
        }
    }
}
