//! Atomic writing of files, and the standard streams of a program.
//!
//! Where a program expects the name of a file, `-` stands for standard input or output. A file of
//! that name is given as `./-`.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::format::printable;

/// Whether a path is `-`, which stands for standard input or output.
pub fn is_standard_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// A file could not be written. An earlier file of that name is unchanged.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {error}", path.display())]
pub struct WriteError {
    /// The file, or `standard output`.
    pub path: PathBuf,
    /// The error of the system.
    pub error: io::Error,
}

/// Writes a file atomically: a temporary file beside it replaces it once complete.
///
/// Links are followed, and an existing file keeps its permissions. A path that is not a regular file,
/// such as a pipe or a device, is written directly. `-` writes to standard output, in one piece once
/// `write` has succeeded.
///
/// # Errors
///
/// `write` fails, or the file cannot be created, written or replaced.
pub fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    if is_standard_stream(path) {
        return write_stream(&mut io::stdout().lock(), write).map_err(|error| WriteError {
            path: PathBuf::from("standard output"),
            error,
        });
    }
    let target = resolved(path);
    let result = match fs::metadata(&target) {
        Ok(metadata) if !metadata.is_file() => write_directly(&target, write),
        Ok(metadata) => write_and_rename(&target, Some(metadata.permissions()), write),
        Err(_) => write_and_rename(&target, None, write),
    };
    result.map_err(|error| WriteError {
        path: path.to_owned(),
        error: without_temporary_name(error),
    })
}

/// The file to which a path leads through its links; it need not exist.
pub fn resolved(path: &Path) -> PathBuf {
    if let Ok(existing) = fs::canonicalize(path) {
        return existing;
    }
    let folder = folder_of(path);
    let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    match fs::read_link(path) {
        // A link to a missing file; only the first link of a chain is resolved.
        Ok(link) => folder.join(link),
        Err(_) => path
            .file_name()
            .map_or_else(|| path.to_owned(), |name| folder.join(name)),
    }
}

/// Writes a value as JSON with [`write_file`].
///
/// # Errors
///
/// See [`write_file`].
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), WriteError> {
    write_file(path, |writer| {
        serde_json::to_writer_pretty(&mut *writer, value)?;
        writer.write_all(b"\n")
    })
}

/// An output of a command would overwrite an input or another output.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TakenError {
    /// A file is an input or another output.
    #[error("{}: is an input or another output of this command: expected a file of its own", .0.display())]
    File(PathBuf),
    /// More than one output goes to standard output.
    #[error("-: standard output is another output of this command: expected a file")]
    StandardOutput,
}

/// Checks that no output would overwrite an input or another output.
///
/// Pipes and devices may be named several times, standard output (`-`) once. As an input, `-` is
/// standard input and never conflicts with an output.
///
/// # Errors
///
/// The first output in conflict.
pub fn check_outputs<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    outputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), TakenError> {
    let files = inputs.into_iter().filter(|path| !is_standard_stream(path));
    let mut taken: Vec<PathBuf> = files.map(resolved).collect();
    let mut standard_output = false;
    for output in outputs {
        if is_standard_stream(output) {
            if standard_output {
                return Err(TakenError::StandardOutput);
            }
            standard_output = true;
            continue;
        }
        let target = resolved(output);
        let is_regular = !target.exists() || target.is_file();
        if is_regular && taken.contains(&target) {
            return Err(TakenError::File(output.to_owned()));
        }
        taken.push(target);
    }
    Ok(())
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

/// Prints an error message to standard error. A failure to do so is ignored.
pub fn print_error(message: &str) {
    let name = if io::stderr().is_terminal() {
        "\x1b[1;31merror:\x1b[0m"
    } else {
        "error:"
    };
    let _ = writeln!(io::stderr(), "{name} {}", printable(message));
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// The error without the name of the temporary file, which is of no use to the user.
fn without_temporary_name(error: io::Error) -> io::Error {
    let message = error.to_string();
    match message.split_once(" at path ") {
        Some((reason, _)) => io::Error::new(error.kind(), reason),
        None => error,
    }
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

fn write_directly(
    target: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut writer = BufWriter::new(OpenOptions::new().write(true).open(target)?);
    write(&mut writer)?;
    writer.flush()
}

fn write_and_rename(
    target: &Path,
    permissions: Option<fs::Permissions>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".brdf-").suffix(".tmp");
    #[cfg(unix)]
    {
        // The permissions of any new file, before the user's umask.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder_of(target))?;
    let mut writer = BufWriter::new(file.as_file_mut());
    write(&mut writer)?;
    writer.flush()?;
    drop(writer);
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    file.persist(target).map_err(|error| error.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complete_file_replaces_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        for text in ["first", "second"] {
            write_file(&path, |w| w.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.txt");
        fs::write(&path, "old").unwrap();
        let failed = write_file(&path, |w| {
            w.write_all(b"half")?;
            Err(io::Error::other("no more"))
        });
        assert!(
            failed
                .unwrap_err()
                .to_string()
                .ends_with("cannot be written: no more")
        );
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_an_error_that_names_the_file() {
        let message = write_file(Path::new("/no/such/folder/x.json"), |_| Ok(())).unwrap_err();
        assert!(
            message
                .to_string()
                .starts_with("/no/such/folder/x.json: cannot be written")
        );
        assert!(!message.to_string().contains(".tmp"), "{message}");
    }

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
    fn standard_output_is_named_once_and_never_conflicts_with_standard_input() {
        let paths = |names: &[&'static str]| -> Vec<&'static Path> {
            names.iter().map(|name| Path::new(*name)).collect()
        };
        let check = |inputs: &[&'static str], outputs: &[&'static str]| {
            check_outputs(paths(inputs), paths(outputs))
        };
        assert!(check(&["-"], &["-", "a.json"]).is_ok());
        assert!(check(&[], &["-", "./-"]).is_ok());
        let twice = check(&["scan.csv"], &["-", "a.json", "-"]);
        assert!(matches!(twice, Err(TakenError::StandardOutput)));
        let input = check(&["scan.csv"], &["-", "scan.csv"]);
        assert!(matches!(input, Err(TakenError::File(path)) if path == Path::new("scan.csv")));
        assert!(check(&["./-"], &["./-"]).is_err());
    }

    #[test]
    fn a_hyphen_alone_is_a_standard_stream() {
        assert!(is_standard_stream(Path::new("-")));
        for file in ["./-", "--", "-x", ""] {
            assert!(!is_standard_stream(Path::new(file)));
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_permissions_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (link, target) = (folder.path().join("link"), folder.path().join("target"));
        symlink("target", &link).unwrap();
        for text in ["first", "second"] {
            write_file(&link, |w| w.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&target).unwrap(), text);
            assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
            fs::set_permissions(&target, fs::Permissions::from_mode(0o600)).unwrap();
        }
        write_file(&target, |w| w.write_all(b"third")).unwrap();
        assert_eq!(
            fs::metadata(&target).unwrap().permissions().mode() & 0o777,
            0o600
        );
    }
}
