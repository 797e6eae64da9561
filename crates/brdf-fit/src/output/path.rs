//! Where paths lead, and whether two of them lead to the same file.

use std::ffi::OsStr;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

use super::temporary::Temporary;

/// The largest number of links that are followed.
const MOST_LINKS: u32 = 40;

/// The file to which a path leads through its links; it need not exist.
pub fn resolved(path: &Path) -> PathBuf {
    within(path, MOST_LINKS)
}

fn within(path: &Path, links: u32) -> PathBuf {
    if let Ok(existing) = fs::canonicalize(path) {
        return existing;
    }
    let Some(name) = path.file_name().filter(|_| links > 0) else {
        return path.to_owned();
    };
    let folder = within(folder_of(path), links - 1);
    match fs::read_link(path) {
        Ok(link) => within(&folder.join(link), links - 1),
        Err(_) => folder.join(name),
    }
}

/// The folder that contains a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// A file that exists, whatever its names: its device and its number there.
#[cfg(unix)]
type Identity = (u64, u64);

#[cfg(unix)]
fn identity(_: &Path, metadata: &Metadata) -> Identity {
    use std::os::unix::fs::MetadataExt as _;
    (metadata.dev(), metadata.ino())
}

/// A file that exists, by its path without links: hard links are not recognised.
#[cfg(not(unix))]
type Identity = PathBuf;

#[cfg(not(unix))]
fn identity(path: &Path, _: &Metadata) -> Identity {
    path.to_owned()
}

/// A regular file, or a file that does not exist yet.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Place {
    path: PathBuf,
    /// `None` where there is no file yet.
    identity: Option<Identity>,
}

impl Place {
    /// The place to which a path leads; `None` for a pipe, a device or a folder, which nothing
    /// replaces.
    pub(super) fn of(path: &Path) -> Option<Self> {
        let path = resolved(path);
        let metadata = fs::metadata(&path).ok();
        if metadata.as_ref().is_some_and(|found| !found.is_file()) {
            return None;
        }
        let identity = metadata.map(|metadata| identity(&path, &metadata));
        Some(Self { path, identity })
    }

    /// The regular file behind a standard stream, such as that of `> FILE`.
    #[cfg(unix)]
    pub(super) fn of_stream(stream: &impl std::os::fd::AsFd) -> Option<Self> {
        let stream = stream.as_fd().try_clone_to_owned().ok()?;
        let metadata = fs::File::from(stream).metadata().ok();
        let metadata = metadata.filter(Metadata::is_file)?;
        Some(Self {
            path: PathBuf::new(),
            identity: Some(identity(Path::new(""), &metadata)),
        })
    }

    #[cfg(not(unix))]
    pub(super) fn of_stream<S>(_: &S) -> Option<Self> {
        None
    }

    /// Whether two places are one, also under several names.
    pub(super) fn is(&self, other: &Self) -> bool {
        match (&self.identity, &other.identity) {
            (Some(own), Some(others)) => own == others,
            (None, None) => self.has_name_of(other),
            _ => false,
        }
    }

    fn has_name_of(&self, other: &Self) -> bool {
        self.path == other.path
            || (differ_in_case_only(&self.path, &other.path) && ignores_case(folder_of(&self.path)))
    }

    /// Whether the place is a folder, or is in a folder, that has this place as its name.
    pub(super) fn contains(&self, folder: &Path) -> bool {
        self.identity.is_none() && folder.starts_with(&self.path)
    }
}

/// Whether two paths name the same folder and names that differ only in capitals.
fn differ_in_case_only(one: &Path, other: &Path) -> bool {
    let name = |path: &Path| Some(path.file_name()?.to_string_lossy().to_lowercase());
    folder_of(one) == folder_of(other) && name(one) == name(other)
}

/// Whether names that differ only in capitals are one file in a folder: found by a temporary file.
fn ignores_case(folder: &Path) -> bool {
    Temporary::create(folder).is_ok_and(|temporary| {
        let name = temporary.path.file_name().map(OsStr::to_ascii_uppercase);
        name.is_some_and(|name| folder.join(name).exists())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn every_link_of_a_chain_is_followed_and_a_circle_ends() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let root = fs::canonicalize(folder.path()).unwrap();
        fs::create_dir(root.join("below")).unwrap();
        for (target, name) in [
            ("below/../second", "first"),
            ("below/missing", "second"),
            ("circle", "circle"),
        ] {
            symlink(target, root.join(name)).unwrap();
        }
        assert_eq!(resolved(&root.join("first")), root.join("below/missing"));
        assert_eq!(
            resolved(&root.join("below/../no/such")),
            root.join("no/such")
        );
        resolved(&root.join("circle"));
    }

    #[test]
    fn names_differ_in_case_within_one_folder() {
        let differ = |one: &str, other: &str| differ_in_case_only(Path::new(one), Path::new(other));
        assert!(differ("a/Fit.json", "a/fit.JSON"));
        assert!(differ("Ä.json", "ä.json"));
        assert!(!differ("a/fit.json", "b/fit.json"));
        assert!(!differ("fit.json", "fits.json"));
    }
}
