//! `-` in the place of a file name: standard input, or standard output.

use std::io::{self, BufWriter, Read as _, Write};
use std::path::Path;

use serde::Serialize;

pub(super) use crate::output::is_standard_stream as is_stream;
use crate::output::{
    self, FilesInUse, TakenError, WriteError, check_outputs, check_writable, resolved, write_file,
};
use crate::read::{LazyScan, ReadError, ReadOptions};
use crate::report::DocumentError;
use crate::scan::Measurements;

/// What a report and a message call the input `-`.
const INPUT: &str = "standard input";

/// What a message calls the output `-`.
const OUTPUT: &str = "standard output";

/// A file of a command: the option or argument that names it, and its path.
pub(super) type Named<'a> = (&'static str, &'a Path);

/// The files of a command cannot all be used together.
#[derive(Debug, thiserror::Error)]
pub(super) enum StreamError {
    #[error(
        "- is given twice as an input ({first}, {second}): standard input can be read only once"
    )]
    InputTwice {
        first: &'static str,
        second: &'static str,
    },
    #[error(
        "{first} and {second} are both written to standard output: expected a file for one of them"
    )]
    OutputTwice {
        first: &'static str,
        second: &'static str,
    },
    #[error("{0} names a folder, which cannot be - (standard output)")]
    Folder(&'static str),
    #[error(transparent)]
    Taken(#[from] TakenError),
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// The path of an input as reports and messages show it.
pub(super) fn shown(path: &Path) -> &Path {
    if is_stream(path) {
        Path::new(INPUT)
    } else {
        path
    }
}

/// Checks that standard input is read at most once, that standard output takes at most one output,
/// that no output replaces an input or another output, and that each can be written. Returns the
/// files, none of which a further output may replace.
///
/// `folder` is one that the command creates, with the folders above it. It is checked by
/// [`check_folder`].
pub(super) fn check<'a>(
    inputs: impl IntoIterator<Item = Named<'a>>,
    outputs: impl IntoIterator<Item = Named<'a>>,
    folder: Option<&Path>,
) -> Result<FilesInUse, StreamError> {
    let inputs: Vec<Named<'_>> = inputs.into_iter().collect();
    let outputs: Vec<Named<'_>> = outputs.into_iter().collect();
    if let [first, second, ..] = options_of_streams(&inputs)[..] {
        return Err(StreamError::InputTwice { first, second });
    }
    if let [first, second, ..] = options_of_streams(&outputs)[..] {
        return Err(StreamError::OutputTwice { first, second });
    }
    let paths = |files: &[Named<'a>]| files.iter().map(|(_, path)| *path).collect::<Vec<_>>();
    let in_use = check_outputs(paths(&inputs), paths(&outputs))?;
    if let Some(folder) = folder {
        in_use.check_folder(folder)?;
    }
    for (_, path) in outputs {
        if !folder.is_some_and(|folder| will_be_created(path, folder)) {
            check_writable(path)?;
        }
    }
    Ok(in_use)
}

/// Checks that an output whose name is found later replaces none of the files in use, and can be
/// written.
pub(super) fn check_further(path: &Path, in_use: &FilesInUse) -> Result<(), StreamError> {
    in_use.check(path)?;
    Ok(check_writable(path)?)
}

/// Whether the folder of a file does not exist yet, and is created with another folder.
fn will_be_created(file: &Path, folder: &Path) -> bool {
    let file = resolved(file);
    let parent = file.parent();
    parent.is_some_and(|parent| !parent.exists() && resolved(folder).starts_with(parent))
}

/// The options that name a standard stream.
fn options_of_streams(files: &[Named<'_>]) -> Vec<&'static str> {
    let streams = files.iter().filter(|(_, path)| is_stream(path));
    streams.map(|(option, _)| *option).collect()
}

/// Checks that a folder is not `-`, and that files can be written into it.
pub(super) fn check_folder((option, path): Named<'_>) -> Result<(), StreamError> {
    if is_stream(path) {
        Err(StreamError::Folder(option))
    } else {
        Ok(output::check_folder(path)?)
    }
}

/// The scans of a file, or of standard input.
pub(super) fn scans(path: &Path, options: &ReadOptions) -> Result<Vec<LazyScan>, ReadError> {
    if !is_stream(path) {
        return LazyScan::open(path, options);
    }
    let all = Measurements::from_stream(INPUT, io::stdin().lock(), options)?;
    Ok(all
        .by_wavelength()
        .into_iter()
        .map(LazyScan::Loaded)
        .collect())
}

/// Everything on standard input.
pub(super) fn bytes() -> Result<Vec<u8>, DocumentError> {
    let mut bytes = Vec::new();
    let read = io::stdin().lock().read_to_end(&mut bytes);
    read.map(|_| bytes).map_err(|error| DocumentError::Io {
        path: INPUT.into(),
        error,
    })
}

/// Writes a file, or standard output. That the reader of standard output closes it early (`| head`)
/// is no error.
pub(super) fn write(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    if !is_stream(path) {
        return write_file(path, write);
    }
    let mut output = BufWriter::new(UntilClosed {
        output: io::stdout().lock(),
        is_closed: false,
    });
    let written = write(&mut output).and_then(|()| output.flush());
    match written {
        Err(error) if !output.get_ref().is_closed => Err(WriteError {
            path: OUTPUT.into(),
            error,
        }),
        _ => Ok(()),
    }
}

/// Writes a value as JSON to a file, or to standard output.
pub(super) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), WriteError> {
    write(path, |writer| {
        serde_json::to_writer_pretty(&mut *writer, value)?;
        writer.write_all(b"\n")
    })
}

/// An output that remembers that its reader has closed it: the error itself may lose its kind on
/// its way through the writers of CSV and JSON.
struct UntilClosed<W> {
    output: W,
    is_closed: bool,
}

impl<W> UntilClosed<W> {
    fn noted<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        if let Err(error) = &result {
            self.is_closed |= error.kind() == io::ErrorKind::BrokenPipe;
        }
        result
    }
}

impl<W: Write> Write for UntilClosed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let result = self.output.write(bytes);
        self.noted(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        let result = self.output.flush();
        self.noted(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(inputs: &[Named<'_>], outputs: &[Named<'_>]) -> String {
        let checked = check(inputs.iter().copied(), outputs.iter().copied(), None);
        checked.map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn each_standard_stream_is_used_once() {
        let stream = Path::new("-");
        assert_eq!(message(&[("FILE", stream)], &[("--json", stream)]), "");
        assert_eq!(
            message(&[("FILE", stream), ("--again", stream)], &[]),
            "- is given twice as an input (FILE, --again): standard input can be read only once"
        );
        assert_eq!(
            message(&[], &[("--json", stream), ("--curves", stream)]),
            "--json and --curves are both written to standard output: expected a file for one of them"
        );
    }

    #[test]
    fn a_closed_output_is_remembered_whatever_becomes_of_its_error() {
        struct Closed;
        impl Write for Closed {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut output = UntilClosed {
            output: Closed,
            is_closed: false,
        };
        let mut table = csv::Writer::from_writer(&mut output);
        assert!(
            table
                .write_record(["a"])
                .and_then(|()| Ok(table.flush()?))
                .is_err()
        );
        drop(table);
        assert!(output.is_closed);
    }
}
