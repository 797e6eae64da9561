//! What differs between the desktop and a page in a browser, each behind a trait: [`Threads`],
//! [`Dialogs`], [`Files`], [`Storage`] and [`Host`], which is what the surroundings leave to the program.
//!
//! [`current`] is the platform that the program is built for. The rest of the viewer is the same on both.
//! The clock needs no trait of its own: `web_time` has the interface of `std::time` on both.
//!
//! The traits are below the state; the implementations use the jobs of the [`worker`](crate::worker).

#[cfg(not(target_arch = "wasm32"))]
pub mod desktop;
mod dialogs;
mod files;
mod host;
#[cfg(target_arch = "wasm32")]
pub mod page;
mod storage;
mod threads;

#[cfg(not(target_arch = "wasm32"))]
pub use desktop as current;
pub use dialogs::Dialogs;
pub use files::{Files, WriteError};
pub use host::Host;
#[cfg(target_arch = "wasm32")]
pub use page as current;
pub use storage::{SaveError, Storage};
pub use threads::Threads;
