//! The desktop: a window of the system, with threads, files and dialogs.

mod dialogs;
mod files;
mod host;
mod program;
mod storage;
mod threads;

pub use dialogs::NativeDialogs;
pub use files::NativeFiles as CurrentFiles;
pub use host::Desktop as CurrentHost;
pub use program::main;
pub use storage::SettingsFile;
pub use threads::NativeThreads as CurrentThreads;
