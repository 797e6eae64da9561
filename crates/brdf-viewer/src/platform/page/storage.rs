//! The settings and the session in what the browser keeps for the page.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io;
use std::path::Path;

use super::{browser, folder};
use crate::platform::{SaveError, Storage};

/// The key of the settings.
const SETTINGS: &str = "brdf-viewer/settings";

/// The key of settings that cannot be used.
const DAMAGED: &str = "brdf-viewer/damaged";

/// What the keys of files begin with; the name follows.
const FILE: &str = "brdf-viewer/file/";

/// The largest content of all files, in characters. Browsers keep 5 million for a page.
const MOST_CHARACTERS: usize = 4_000_000;

/// What the browser keeps for the page: the settings, and the files of the session.
#[derive(Debug)]
pub(super) struct LocalStorage {
    local: web_sys::Storage,
    /// The files that do not fit, of which the user knows.
    refused: RefCell<BTreeSet<String>>,
}

impl LocalStorage {
    /// What the browser keeps, if it keeps anything. The files of the last session are brought back.
    pub(super) fn open() -> Option<Self> {
        let local = browser::storage()?;
        let storage = Self {
            local,
            refused: RefCell::default(),
        };
        for name in storage.files() {
            let kept = storage.local.get_item(&format!("{FILE}{name}"));
            if let Some(content) = kept.ok().flatten().and_then(|text| decoded(&text)) {
                folder::add(&name, &content);
            }
        }
        Some(storage)
    }

    /// The names of the files that are kept.
    fn files(&self) -> Vec<String> {
        let count = self.local.length().unwrap_or(0);
        let keys = (0..count).filter_map(|i| self.local.key(i).ok().flatten());
        keys.filter_map(|key| key.strip_prefix(FILE).map(str::to_owned))
            .collect()
    }

    fn set(&self, key: &str, text: &str) -> Result<(), String> {
        let set = self.local.set_item(key, text);
        set.map_err(|_| "its storage is full or not allowed".to_owned())
    }

    /// The number of characters of all files that are kept.
    fn characters(&self) -> usize {
        let lengths = self.files().into_iter().map(|name| {
            let kept = self.local.get_item(&format!("{FILE}{name}"));
            kept.ok()
                .flatten()
                .map_or(0, |text| text.encode_utf16().count())
        });
        lengths.sum()
    }

    /// Keeps a file, if it fits.
    fn keep(&self, name: &str, content: &[u8]) -> bool {
        let text = encoded(content);
        let length = text.encode_utf16().count();
        self.characters() + length <= MOST_CHARACTERS
            && self.set(&format!("{FILE}{name}"), &text).is_ok()
    }
}

impl Storage for LocalStorage {
    fn name(&self) -> String {
        format!("{SETTINGS} in the browser")
    }

    fn read(&self) -> io::Result<Option<String>> {
        let text = self.local.get_item(SETTINGS);
        text.map_err(|error| io::Error::other(browser::in_words(&error)))
    }

    fn write(&self, text: &str, files: &[&Path]) -> Result<Vec<String>, SaveError> {
        let needed: BTreeSet<String> = files
            .iter()
            .filter_map(|path| path.to_str().map(str::to_owned))
            .collect();
        let kept = self.files();
        for name in kept.iter().filter(|name| !needed.contains(*name)) {
            let _ = self.local.remove_item(&format!("{FILE}{name}"));
        }
        self.set(SETTINGS, text).map_err(SaveError::Browser)?;
        let mut notes = Vec::new();
        for name in needed {
            let Some(content) = folder::content(Path::new(&name)) else {
                continue;
            };
            if kept.contains(&name) || self.refused.borrow().contains(&name) {
                continue;
            }
            if !self.keep(&name, &content) {
                notes.push(format!(
                    "{name}: is too large for the browser to keep with those that are open: expected it to \
                     be opened again in the next session"
                ));
                self.refused.borrow_mut().insert(name);
            }
        }
        Ok(notes)
    }

    fn set_aside(&self) -> io::Result<String> {
        let text = self.read()?.unwrap_or_default();
        self.set(DAMAGED, &text).map_err(io::Error::other)?;
        let _ = self.local.remove_item(SETTINGS);
        Ok(format!("{DAMAGED} in the browser"))
    }
}

/// A file as text: that of UTF-8 as it is, of other bytes a character for each.
fn encoded(content: &[u8]) -> String {
    match str::from_utf8(content) {
        Ok(text) => format!("t{text}"),
        Err(_) => std::iter::once('b')
            .chain(content.iter().map(|byte| char::from(*byte)))
            .collect(),
    }
}

/// The file of a text; `None` if it is not one of [`encoded`].
fn decoded(text: &str) -> Option<Vec<u8>> {
    if let Some(text) = text.strip_prefix('t') {
        return Some(text.as_bytes().to_vec());
    }
    let bytes = text.strip_prefix('b')?.chars();
    bytes.map(|byte| u8::try_from(byte).ok()).collect()
}
