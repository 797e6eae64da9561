//! The files that were brought into the page. A page cannot read the folders of the computer: what the user
//! drops or chooses is copied to this one, which ends with the page.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

thread_local! {
    /// By name. The page has one thread.
    static FILES: RefCell<BTreeMap<PathBuf, Rc<[u8]>>> = const { RefCell::new(BTreeMap::new()) };
}

/// Adds a file, and returns its path. The same file is added once; another one of the same name gets a
/// number.
pub(super) fn add(name: &str, content: &[u8]) -> PathBuf {
    FILES.with_borrow_mut(|files| {
        let names = std::iter::once(PathBuf::from(name)).chain((2..).map(|i| numbered(name, i)));
        for path in names {
            match files.get(&path) {
                Some(known) if **known == *content => return path,
                Some(_) => {}
                None => {
                    files.insert(path.clone(), content.into());
                    return path;
                }
            }
        }
        PathBuf::from(name)
    })
}

/// The content of a file.
pub(super) fn content(path: &Path) -> Option<Rc<[u8]>> {
    FILES.with_borrow(|files| files.get(path).cloned())
}

/// "paint.csv" as "paint (2).csv".
fn numbered(name: &str, number: u32) -> PathBuf {
    match name.rsplit_once('.') {
        Some((stem, extension)) => PathBuf::from(format!("{stem} ({number}).{extension}")),
        None => PathBuf::from(format!("{name} ({number})")),
    }
}
