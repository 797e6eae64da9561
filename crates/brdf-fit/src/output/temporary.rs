//! Temporary files, each of which becomes an output once it is complete.
//!
//! A run that ends early removes its temporary files: after an error when they are dropped, before a
//! signal ends the program by [`abandon`]. A run that is killed cannot. What it leaves is removed by
//! the next run that writes into the folder, which knows it by its name and by its lock: a temporary
//! file is locked as long as its process lives.

use std::collections::HashSet;
use std::fs::{self, DirEntry, File, TryLockError};
use std::io::{self, ErrorKind};
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{NamedTempFile, TempPath};

/// The beginning of the name of a temporary file.
const PREFIX: &str = ".brdf-output-";

/// The number of random letters and digits that follow.
const RANDOM: usize = 16;

/// The ending of the name.
const SUFFIX: &str = ".tmp";

/// How often a file is created that another process takes for a leftover.
const ATTEMPTS: usize = 100;

/// The temporary files of this process. A file is created and named here under one lock.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The folders in which this process has looked for leftovers.
static CLEANED: Mutex<Option<HashSet<PathBuf>>> = Mutex::new(None);

fn locked<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of this process, which is about to end.
///
/// None can be created or become an output any more: a thread that tries waits for the end.
pub fn abandon() {
    let unfinished = locked(&UNFINISHED);
    for path in unfinished.iter() {
        let _ = fs::remove_file(path);
    }
    mem::forget(unfinished);
}

/// A temporary file, which is removed when it is dropped.
pub(super) struct Temporary {
    pub(super) file: File,
    pub(super) path: TempPath,
    _registered: Registered,
}

/// A path in [`UNFINISHED`] as long as this value lives.
struct Registered(PathBuf);

impl Drop for Registered {
    fn drop(&mut self) {
        locked(&UNFINISHED).retain(|path| *path != self.0);
    }
}

impl Temporary {
    /// Creates a temporary file in a folder.
    ///
    /// # Errors
    ///
    /// The folder is missing, or no file can be created in it.
    pub(super) fn create(folder: &Path) -> io::Result<Self> {
        remove_leftovers_once(folder);
        let mut unfinished = locked(&UNFINISHED);
        for _ in 0..ATTEMPTS {
            let (file, path) = new_file(folder)?.into_parts();
            if is_own(&file, &path) {
                let registered = Registered(path.to_path_buf());
                unfinished.push(registered.0.clone());
                return Ok(Self {
                    file,
                    path,
                    _registered: registered,
                });
            }
        }
        Err(ErrorKind::ResourceBusy.into())
    }

    /// Makes the file an output, in place of an earlier one.
    ///
    /// # Errors
    ///
    /// The file cannot be renamed; it is removed.
    pub(super) fn persist(self, target: &Path) -> io::Result<()> {
        let unfinished = locked(&UNFINISHED);
        let renamed = self.path.persist(target);
        drop(unfinished);
        renamed.map_err(|error| error.error)
    }
}

fn new_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM).suffix(SUFFIX);
    #[cfg(unix)]
    {
        // The permissions of any new file, before the user's umask.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// Locks a new file. `false` if another process, which looks for leftovers, came first and removes it.
///
/// Where the file system has no locks, no process removes a leftover.
fn is_own(file: &File, path: &Path) -> bool {
    !matches!(file.try_lock(), Err(TryLockError::WouldBlock)) && path.exists()
}

/// Removes what killed processes left in a folder, once in the life of this process.
fn remove_leftovers_once(folder: &Path) {
    let mut cleaned = locked(&CLEANED);
    let cleaned = cleaned.get_or_insert_default();
    if cleaned.insert(folder.to_owned()) {
        remove_leftovers(folder);
    }
}

/// Removes the temporary files of processes that no longer live; all other files stay.
fn remove_leftovers(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if is_temporary(&entry) {
            remove_unowned(&entry.path());
        }
    }
}

/// Whether an entry is a regular file with the name of a temporary file.
fn is_temporary(entry: &DirEntry) -> bool {
    let name = entry.file_name();
    let random = name
        .to_str()
        .and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX));
    let has_name = random.is_some_and(|random| {
        random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
    });
    has_name && entry.file_type().is_ok_and(|kind| kind.is_file())
}

/// Removes a temporary file that no process has locked.
fn remove_unowned(path: &Path) {
    let Ok(file) = File::open(path) else { return };
    // The lock is held until the file is removed, so that its process, if it has just created the file,
    // notices.
    if file.try_lock().is_ok() {
        let _ = fs::remove_file(path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn leftovers_are_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let name = |middle: &str| format!("{PREFIX}{middle}{SUFFIX}");
        let kept = [
            name("0123456789abcde"),
            name("0123456789abcdefg"),
            name("0123456789abcde-"),
            name("0123456789abcd.."),
            format!("x{}", name("0123456789abcdef")),
            format!("{}~", name("0123456789abcdef")),
            ".brdf-backup.tmp".to_owned(),
            "scan.csv".to_owned(),
        ];
        for file in &kept {
            fs::write(folder.path().join(file), "kept").unwrap();
        }
        let folder_of_that_name = name("aaaaaaaaaaaaaaaa");
        fs::create_dir(folder.path().join(&folder_of_that_name)).unwrap();
        let mut expected = kept.to_vec();
        expected.push(folder_of_that_name);
        #[cfg(unix)]
        {
            let link = name("bbbbbbbbbbbbbbbb");
            std::os::unix::fs::symlink("scan.csv", folder.path().join(&link)).unwrap();
            expected.push(link);
        }
        let living = Temporary::create(folder.path()).unwrap();
        expected.push(
            living
                .path
                .file_name()
                .unwrap()
                .to_str()
                .unwrap()
                .to_owned(),
        );
        for leftover in ["0123456789abcdef", "ABCDEFGHIJKLMNOP"] {
            fs::write(folder.path().join(name(leftover)), "half").unwrap();
        }
        remove_leftovers(folder.path());
        expected.sort();
        assert_eq!(names(folder.path()), expected);
    }

    #[test]
    fn a_new_file_that_is_taken_for_a_leftover_is_not_used() {
        let folder = tempfile::tempdir().unwrap();
        let (file, path) = new_file(folder.path()).unwrap().into_parts();
        let other = File::open(&path).unwrap();
        other.lock().unwrap();
        assert!(!is_own(&file, &path), "another process looks at it");
        fs::remove_file(&path).unwrap();
        drop(other);
        assert!(!is_own(&file, &path), "another process has removed it");
    }

    #[test]
    fn the_first_output_into_a_folder_removes_leftovers() {
        let folder = tempfile::tempdir().unwrap();
        let leftover = new_file(folder.path()).unwrap().into_temp_path();
        let file = Temporary::create(folder.path()).unwrap();
        assert!(!leftover.exists());
        let target = folder.path().join("out");
        file.persist(&target).unwrap();
        assert_eq!(names(folder.path()), ["out"]);
        assert!(
            !locked(&UNFINISHED)
                .iter()
                .any(|path| path.starts_with(folder.path()))
        );
    }

    #[test]
    fn a_dropped_file_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        drop(Temporary::create(folder.path()).unwrap());
        assert!(names(folder.path()).is_empty());
    }
}
