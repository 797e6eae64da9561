//! The dialogs of the browser.

use std::path::Path;

use wasm_bindgen::JsCast as _;
use wasm_bindgen::closure::Closure;
use web_sys::{File, HtmlInputElement};

use super::browser::{element, in_words};
use super::files::{Brought, bring};
use crate::events::EventSender;
use crate::job::Event;
use crate::output_kind::OutputKind;
use crate::platform::Dialogs;
use crate::worker::extensions;

/// The dialog of the browser for files to open. What is written becomes a download, for which the browser
/// asks itself where it is set to do so.
#[derive(Debug)]
pub(super) struct BrowserDialogs;

impl Dialogs for BrowserDialogs {
    fn available(&self) -> bool {
        true
    }

    fn open(&self, events: EventSender) {
        let Ok(input) = element::<HtmlInputElement>("input") else {
            return;
        };
        input.set_type("file");
        input.set_multiple(true);
        let accepted: Vec<String> = extensions().iter().map(|e| format!(".{e}")).collect();
        input.set_accept(&accepted.join(","));
        let chosen = input.clone();
        let changed = Closure::once_into_js(move || {
            let files = chosen.files();
            let all = files
                .iter()
                .flat_map(|files| (0..files.length()).filter_map(|i| files.get(i)));
            bring(all.map(brought).collect(), events);
        });
        input.set_onchange(Some(changed.unchecked_ref()));
        input.click();
    }

    fn export(&self, kind: OutputKind, suggested: &Path, events: EventSender) {
        // A folder of its own: a download never replaces a file that was opened.
        let path = Path::new("downloads").join(suggested.file_name().unwrap_or_default());
        events.send(Event::OutputChosen(kind, path));
    }
}

fn brought(file: File) -> Brought {
    Brought {
        name: file.name(),
        content: Box::pin(async move {
            let buffer = file.array_buffer().await;
            let buffer = buffer.map_err(|error| in_words(&error))?;
            Ok(js_sys::Uint8Array::new(&buffer).to_vec())
        }),
    }
}
