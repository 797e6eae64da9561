//! The program of a page. The page and its worker both start it: where there is a window it shows the viewer
//! in the canvas, otherwise it fits.

use std::process::ExitCode;
use std::rc::Rc;

use eframe::egui;
use wasm_bindgen::JsCast as _;
use wasm_bindgen::closure::Closure;
use web_sys::{HtmlCanvasElement, KeyboardEvent, Window};

use super::browser::{document, in_words, show_message};
use super::dialogs::BrowserDialogs;
use super::places::Places;
use super::service::serve;
use super::storage::LocalStorage;
use crate::Viewer;
use crate::platform::Storage;
use crate::shortcuts;
use crate::state::built_in;
use crate::state::saved::Settings;

/// The identifier of the canvas.
const CANVAS: &str = "viewer";

/// What is said when the browser keeps nothing.
const NOTHING_KEPT: &str =
    "this browser keeps nothing for the page: settings and session end with it";

/// Starts the page or its worker, and returns at once.
pub fn main() -> ExitCode {
    let Some(window) = web_sys::window() else {
        serve();
        return ExitCode::SUCCESS;
    };
    std::panic::set_hook(Box::new(|panic| {
        show_message(Some(&format!(
            "The viewer has ended by an internal error: {panic}. Reload the page: settings and session are kept."
        )));
    }));
    let canvas = document().and_then(|document| document.get_element_by_id(CANVAS));
    match canvas.and_then(|canvas| canvas.dyn_into::<HtmlCanvasElement>().ok()) {
        Some(canvas) => start(&window, canvas),
        None => show_message(Some(
            "The page has no canvas: expected index.html of the viewer.",
        )),
    }
    ExitCode::SUCCESS
}

fn start(window: &Window, canvas: HtmlCanvasElement) {
    take_keys(window);
    let address = Address::of(window);
    wasm_bindgen_futures::spawn_local(async move {
        let of_page = canvas.clone();
        let create = move |creation: &eframe::CreationContext| {
            if address.tells_places {
                creation.egui_ctx.add_plugin(Places { canvas: CANVAS });
            }
            assert!(!address.panics, "asked for by the address");
            let viewer = viewer(&creation.egui_ctx, &address);
            let page = Page {
                viewer,
                canvas: of_page,
                shown: None,
            };
            Ok(Box::new(page) as Box<dyn eframe::App>)
        };
        let options = eframe::WebOptions::default();
        let runner = eframe::WebRunner::new();
        match runner
            .start(canvas.clone(), options, Box::new(create))
            .await
        {
            // Keys reach the viewer without a click.
            Ok(()) => {
                let _ = canvas.focus();
            }
            Err(error) => show_message(Some(&format!(
                "The viewer cannot draw in this browser: {}. It needs WebGL.",
                in_words(&error)
            ))),
        }
    });
}

/// The viewer with the last session, and the sample of the address.
fn viewer(ctx: &egui::Context, address: &Address) -> Viewer {
    let storage = LocalStorage::open().map(|kept| Rc::new(kept) as Rc<dyn Storage>);
    let keeps_nothing = storage.is_none();
    let mut viewer = Viewer::new(ctx, Box::new(BrowserDialogs), Settings::load(storage));
    if keeps_nothing {
        viewer.state.report_note(NOTHING_KEPT);
    }
    let entry = address.sample.as_deref().and_then(built_in::entry_named);
    if let Some(entry) = entry {
        viewer.open_linked(entry);
        return viewer;
    }
    viewer.open_at_start(Vec::new());
    if let Some(name) = &address.sample {
        let known: Vec<String> = built_in::link_names().collect();
        viewer.state.report_error(format!(
            "the address asks for the sample {name}: expected one of {}",
            known.join(", ")
        ));
    }
    viewer
}

/// What the address of the page asks for.
struct Address {
    /// The built-in sample of `#sample=NAME`.
    sample: Option<String>,
    /// Whether the tests ask for the places of controls, by `?places`.
    tells_places: bool,
    /// Whether the tests ask for a panic, by `?panic`.
    panics: bool,
}

impl Address {
    fn of(window: &Window) -> Self {
        let location = window.location();
        let fragment = location.hash().unwrap_or_default();
        let sample = fragment.strip_prefix("#sample=").map(|name| {
            let decoded = js_sys::decode_uri_component(name);
            decoded.map_or_else(|_| name.to_owned(), String::from)
        });
        let search = location.search().unwrap_or_default();
        Self {
            sample,
            tells_places: search == "?places",
            panics: search == "?panic",
        }
    }
}

/// Keeps the browser from acting on the keys of the viewer, such as F5, before it sees them.
fn take_keys(window: &Window) {
    let pressed = Closure::<dyn Fn(KeyboardEvent)>::new(|event: KeyboardEvent| {
        let command = event.ctrl_key() || event.meta_key();
        if shortcuts::is_key_of_program(&event.key(), command) {
            event.prevent_default();
        }
    });
    let listener = pressed.as_ref().unchecked_ref();
    let _ = window.add_event_listener_with_callback_and_bool("keydown", listener, true);
    pressed.forget();
}

/// The viewer in its canvas, which states in attributes what the viewer does: `data-status`, `data-busy` and
/// `data-errors`. The tests of the page read them.
struct Page {
    viewer: Viewer,
    canvas: HtmlCanvasElement,
    shown: Option<[String; 3]>,
}

impl eframe::App for Page {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.viewer.frame(ui);
        let state = &self.viewer.state;
        let errors = state.errors().join("\n");
        let now = [
            state.status.clone(),
            self.viewer.is_busy().to_string(),
            errors,
        ];
        if self.shown.is_none() {
            show_message(None);
        }
        if self.shown.as_ref() != Some(&now) {
            for (name, value) in ["data-status", "data-busy", "data-errors"].iter().zip(&now) {
                let _ = self.canvas.set_attribute(name, value);
            }
            self.shown = Some(now);
        }
    }
}
