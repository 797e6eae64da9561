//! A page in a browser, which has neither threads nor files, and the worker of the browser that fits for it.

mod browser;
mod dialogs;
mod files;
mod folder;
mod host;
mod order;
mod places;
mod program;
mod service;
mod storage;
mod threads;

pub use files::PageFiles as CurrentFiles;
pub use host::Page as CurrentHost;
pub use program::main;
pub use threads::WebWorker as CurrentThreads;
