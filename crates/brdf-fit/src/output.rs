//! Writing a file whole or not at all, and the two streams of a command.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

/// A file could not be written; what was there before is still there.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {error}", path.display())]
pub struct WriteError {
    /// The file.
    pub path: PathBuf,
    /// What the system says.
    pub error: io::Error,
}

/// Writes a file by way of a temporary one beside it, which takes its place when it is complete.
///
/// A link is followed, and a file keeps its permissions. What is not a regular file (a pipe, a
/// device) is written to directly.
pub fn write_file(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    let target = resolved(path);
    let result = match fs::metadata(&target) {
        Ok(metadata) if !metadata.is_file() => write_directly(&target, write),
        Ok(metadata) => write_and_rename(&target, Some(metadata.permissions()), write),
        Err(_) => write_and_rename(&target, None, write),
    };
    result.map_err(|error| WriteError {
        path: path.to_owned(),
        error: plain(error),
    })
}

/// The file that a path leads to over its links, also where that does not exist yet.
pub fn resolved(path: &Path) -> PathBuf {
    if let Ok(existing) = fs::canonicalize(path) {
        return existing;
    }
    let folder = folder_of(path);
    let folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
    match fs::read_link(path) {
        // One link to a file that is not there; of a chain, the first link is resolved.
        Ok(link) => folder.join(link),
        Err(_) => path
            .file_name()
            .map_or_else(|| path.to_owned(), |name| folder.join(name)),
    }
}

/// Writes a value as JSON, by [`write_file`].
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), WriteError> {
    write_file(path, |writer| {
        serde_json::to_writer_pretty(&mut *writer, value)?;
        writer.write_all(b"\n")
    })
}

/// An output of a command that would take the place of an input or of another output.
#[derive(Debug, thiserror::Error)]
#[error("{}: is an input or another output of this command: expected a file of its own", .0.display())]
pub struct TakenError(pub PathBuf);

/// Checks that no output takes the place of an input or of another output. Pipes and devices may be
/// named several times.
pub fn check_outputs<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    outputs: impl IntoIterator<Item = &'a Path>,
) -> Result<(), TakenError> {
    let mut taken: Vec<PathBuf> = inputs.into_iter().map(resolved).collect();
    for output in outputs {
        let target = resolved(output);
        let is_regular = !target.exists() || target.is_file();
        if is_regular && taken.contains(&target) {
            return Err(TakenError(output.to_owned()));
        }
        taken.push(target);
    }
    Ok(())
}

/// Prints to standard output. A reader that has seen enough (`| head`) is no error.
pub fn print(bytes: &[u8]) -> io::Result<()> {
    let mut output = io::stdout().lock();
    match output.write_all(bytes).and_then(|()| output.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        result => result,
    }
}

/// An error line on standard error; where that is gone, nobody is there to be told.
pub fn print_error(message: &str) {
    let name = if io::stderr().is_terminal() {
        "\x1b[1;31merror:\x1b[0m"
    } else {
        "error:"
    };
    let _ = writeln!(io::stderr(), "{name} {message}");
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// What the system says, without the name of a temporary file that the user does not know.
fn plain(error: io::Error) -> io::Error {
    let words = error.to_string();
    match words.split_once(" at path ") {
        Some((reason, _)) => io::Error::new(error.kind(), reason),
        None => error,
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
        // As any new file has, less what the user's umask takes away.
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
    fn a_complete_file_takes_the_place_of_the_old_one() {
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
