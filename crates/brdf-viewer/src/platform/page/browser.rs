//! The parts of a browser that a page needs.

use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Blob, BlobPropertyBag, Document, HtmlAnchorElement, Storage, Url};

/// The document of the page; `None` in a worker of the browser.
pub(super) fn document() -> Option<Document> {
    web_sys::window()?.document()
}

/// The text that the browser keeps for pages of this address; `None` where it keeps nothing.
pub(super) fn storage() -> Option<Storage> {
    web_sys::window()?.local_storage().ok().flatten()
}

/// A new element of the page.
///
/// # Errors
///
/// There is no document.
pub(super) fn element<T: JsCast>(name: &str) -> Result<T, JsValue> {
    let document = document().ok_or("no document")?;
    document
        .create_element(name)?
        .dyn_into()
        .map_err(JsValue::from)
}

/// Shows a text above the viewer, or hides it.
pub(super) fn show_message(text: Option<&str>) {
    let message = document().and_then(|document| document.get_element_by_id("message"));
    if let Some(message) = message {
        let _ = message.toggle_attribute_with_force("hidden", text.is_none());
        message.set_text_content(text);
    }
}

/// Puts a file among the downloads of the browser.
///
/// # Errors
///
/// The message of the browser.
pub(super) fn download(name: &str, bytes: &[u8]) -> Result<(), String> {
    let started = || -> Result<(), JsValue> {
        let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
        let kind = BlobPropertyBag::new();
        // Of any other type, some browsers show the file in place of the page.
        kind.set_type("application/octet-stream");
        let blob = Blob::new_with_u8_array_sequence_and_options(&parts, &kind)?;
        let url = Url::create_object_url_with_blob(&blob)?;
        let link: HtmlAnchorElement = element("a")?;
        link.set_href(&url);
        link.set_download(name);
        link.click();
        // The browser takes hold of the content when the link is followed.
        Url::revoke_object_url(&url)
    };
    started().map_err(|error| in_words(&error))
}

/// An error of the browser in words.
pub(super) fn in_words(error: &JsValue) -> String {
    let error = error.dyn_ref::<js_sys::Error>();
    error.map_or_else(
        || "unknown error".to_owned(),
        |error| String::from(error.message()),
    )
}
