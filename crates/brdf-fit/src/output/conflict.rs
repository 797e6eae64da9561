//! Outputs that would overwrite an input or another output.

use std::io;
use std::path::{Path, PathBuf};

use super::is_standard_stream;
use super::path::{Place, resolved};

/// An output of a command would overwrite an input or another output.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TakenError {
    /// A file is an input or another output.
    #[error("{}: is an input or another output of this command: expected a file of its own", .0.display())]
    File(PathBuf),
    /// A file is an input or another output under another name.
    #[error(
        "{}: is the same file as {}, an input or another output of this command: expected a file of \
         its own",
        path.display(), other.display()
    )]
    SameFile {
        /// The output.
        path: PathBuf,
        /// The name of the input or of the other output.
        other: PathBuf,
    },
    /// A file would be where a folder of another output is.
    #[error("{}: is a folder of another output of this command: expected a file", .0.display())]
    Folder(PathBuf),
    /// More than one output goes to standard output.
    #[error("-: standard output is another output of this command: expected a file")]
    StandardOutput,
}

/// The inputs and outputs of a command, none of which another output may overwrite.
///
/// Paths are compared by the files to which they lead: through links, hard links (on Unix) and other
/// spellings. Pipes, devices and folders are not overwritten, and never in conflict.
#[derive(Debug, Default)]
pub struct FilesInUse {
    files: Vec<(PathBuf, Place)>,
}

impl FilesInUse {
    /// The inputs of a command; `-` is standard input.
    ///
    /// Standard output, if it is redirected to a file, is in use from the start.
    ///
    /// # Errors
    ///
    /// Standard output goes to one of the inputs.
    pub fn of_inputs<'a>(inputs: impl IntoIterator<Item = &'a Path>) -> Result<Self, TakenError> {
        let mut files = Self::default();
        for input in inputs {
            if is_standard_stream(input) {
                files.add_at("standard input", Place::of_stream(&io::stdin()));
            } else {
                files.add(input);
            }
        }
        let (name, place) = ("standard output", Place::of_stream(&io::stdout()));
        files.check_at(Path::new(name), place.as_ref())?;
        files.add_at(name, place);
        Ok(files)
    }

    /// Adds a file.
    pub fn add(&mut self, path: &Path) {
        self.add_at(path, Place::of(path));
    }

    fn add_at(&mut self, name: impl Into<PathBuf>, place: Option<Place>) {
        self.files.extend(place.map(|place| (name.into(), place)));
    }

    /// Checks that an output would overwrite none of the files.
    ///
    /// # Errors
    ///
    /// It would.
    pub fn check(&self, output: &Path) -> Result<(), TakenError> {
        self.check_at(output, Place::of(output).as_ref())
    }

    fn check_at(&self, output: &Path, place: Option<&Place>) -> Result<(), TakenError> {
        let is_taken = |(_, taken): &&(PathBuf, Place)| place.is_some_and(|place| place.is(taken));
        match self.files.iter().find(is_taken) {
            None => Ok(()),
            Some((name, _)) if name == output => Err(TakenError::File(output.to_owned())),
            Some((name, _)) => Err(TakenError::SameFile {
                path: output.to_owned(),
                other: name.clone(),
            }),
        }
    }

    /// Checks that a folder that will be created, and the folders above it, are none of the files.
    ///
    /// # Errors
    ///
    /// The first file that is.
    pub fn check_folder(&self, folder: &Path) -> Result<(), TakenError> {
        let folder = resolved(folder);
        let mut files = self.files.iter();
        match files.find(|(_, place)| place.contains(&folder)) {
            None => Ok(()),
            Some((name, _)) => Err(TakenError::Folder(name.clone())),
        }
    }
}

/// Checks that no output would overwrite an input or another output.
///
/// Pipes and devices may be named several times, standard output (`-`) once. As an input, `-` is
/// standard input. A file to which a standard stream is redirected is in use as well.
///
/// # Errors
///
/// The first output in conflict.
pub fn check_outputs<'a>(
    inputs: impl IntoIterator<Item = &'a Path>,
    outputs: impl IntoIterator<Item = &'a Path>,
) -> Result<FilesInUse, TakenError> {
    let mut in_use = FilesInUse::of_inputs(inputs)?;
    let mut standard_output = false;
    for output in outputs {
        if !is_standard_stream(output) {
            in_use.check(output)?;
            in_use.add(output);
        } else if std::mem::replace(&mut standard_output, true) {
            return Err(TakenError::StandardOutput);
        }
    }
    Ok(in_use)
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_file_is_no_folder_of_another_output() {
        let mut in_use = FilesInUse::default();
        in_use.add(Path::new("no-such-folder/out"));
        for (folder, is_free) in [
            ("no-such-folder", true),
            ("no-such-folder/out", false),
            ("no-such-folder/out/figures", false),
            ("no-such-folder/output", true),
        ] {
            let checked = in_use.check_folder(Path::new(folder));
            assert_eq!(checked.is_ok(), is_free, "{folder}");
        }
    }
}
