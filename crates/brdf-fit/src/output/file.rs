//! Atomic writing of files, and whether a file can be written.

use std::fs::{self, Metadata, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::path::{folder_of, resolved};
use super::temporary::Temporary;
use super::{is_standard_stream, write_stream};

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
/// Links are followed, and an existing file keeps its permissions; one that is read-only is not
/// replaced. A path that is not a regular file, such as a pipe or a device, is written directly. `-`
/// writes to standard output, in one piece once `write` has succeeded.
///
/// The temporary file is removed after an error, by [`abandon`](super::abandon), and after the end of a
/// killed process by the next one that writes into the folder.
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
        Ok(metadata) => replaceable(&target, &metadata).and_then(|()| {
            if metadata.is_file() {
                write_and_rename(&target, Some(metadata.permissions()), write)
            } else {
                write_directly(&target, write)
            }
        }),
        Err(_) => write_and_rename(&target, None, write),
    };
    result.map_err(|error| failed(path, error))
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

/// Checks, before the content is known, that [`write_file`] can write a file.
///
/// # Errors
///
/// The file is read-only or a folder, its folder is missing or read-only, or the path names no file.
pub fn check_writable(path: &Path) -> Result<(), WriteError> {
    if is_standard_stream(path) {
        return Ok(());
    }
    let target = resolved(path);
    let checked = match fs::metadata(&target) {
        Ok(metadata) => replaceable(&target, &metadata).and_then(|()| {
            if metadata.is_file() {
                check_creation(folder_of(&target))
            } else {
                Ok(())
            }
        }),
        Err(error) => creatable(path, &target, error),
    };
    checked.map_err(|error| failed(path, error))
}

/// Checks that files can be written into a folder, which is created if it does not exist.
///
/// # Errors
///
/// The folder, or the part of its path that exists, is read-only or not a folder.
pub fn check_folder(path: &Path) -> Result<(), WriteError> {
    let checked = match existing_part(path) {
        existing if existing.is_dir() => check_creation(existing),
        existing => Err(not_a_folder(existing)),
    };
    checked.map_err(|error| failed(path, error))
}

fn failed(path: &Path, error: io::Error) -> WriteError {
    WriteError {
        path: path.to_owned(),
        error: without_temporary_name(error),
    }
}

/// Whether an existing file may be replaced, or written directly.
fn replaceable(target: &Path, metadata: &Metadata) -> io::Result<()> {
    if metadata.is_dir() {
        let message = "it is a folder: expected the name of a file";
        return Err(io::Error::new(ErrorKind::IsADirectory, message));
    }
    if !metadata.is_file() {
        return Ok(());
    }
    // A file can be read-only for all, which does not stop root, or for this user.
    let is_open = OpenOptions::new().write(true).open(target).map(drop);
    match is_open {
        Ok(()) if !metadata.permissions().readonly() => Ok(()),
        Err(error) if error.kind() != ErrorKind::PermissionDenied => Err(error),
        _ => Err(io::Error::new(
            ErrorKind::PermissionDenied,
            "the file is read-only",
        )),
    }
}

/// Whether a file that does not exist can be created; `error` is why it cannot be found.
fn creatable(path: &Path, target: &Path, error: io::Error) -> io::Result<()> {
    let folder = folder_of(path);
    let missing = if folder.exists() {
        folder_of(target)
    } else {
        folder
    };
    let ends_as_folder = path.to_string_lossy().ends_with(std::path::is_separator);
    let wrong = |message: String| Err(io::Error::new(ErrorKind::InvalidInput, message));
    match existing_part(folder) {
        existing if !existing.is_dir() => Err(not_a_folder(existing)),
        _ if path.file_name().is_none() => wrong("expected the name of a file".to_owned()),
        _ if ends_as_folder => {
            wrong("the name is that of a folder: expected the name of a file".to_owned())
        }
        _ if error.kind() != ErrorKind::NotFound => Err(error),
        _ if !missing.exists() => Err(io::Error::new(
            ErrorKind::NotFound,
            format!("the folder {} does not exist", missing.display()),
        )),
        _ => check_creation(missing),
    }
}

/// The path of a folder, up to the last part that exists.
fn existing_part(path: &Path) -> &Path {
    let mut parts = path.ancestors();
    let exists = |part: &&Path| fs::symlink_metadata(part).is_ok();
    parts.find(exists).unwrap_or(Path::new("."))
}

fn not_a_folder(path: &Path) -> io::Error {
    let message = format!("{} is not a folder", path.display());
    io::Error::new(ErrorKind::NotADirectory, message)
}

/// The error without the name of the temporary file, which is of no use to the user.
fn without_temporary_name(error: io::Error) -> io::Error {
    let message = error.to_string();
    match message.split_once(" at path ") {
        Some((reason, _)) => io::Error::new(error.kind(), reason),
        None => error,
    }
}

/// Whether a file can be created in a folder: whatever forbids it, one attempt finds out.
fn check_creation(folder: &Path) -> io::Result<()> {
    Temporary::create(folder).map(drop)
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
    let temporary = Temporary::create(folder_of(target))?;
    let mut writer = BufWriter::new(&temporary.file);
    write(&mut writer)?;
    writer.flush()?;
    drop(writer);
    if let Some(permissions) = permissions {
        temporary.file.set_permissions(permissions)?;
    }
    temporary.persist(target)
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
