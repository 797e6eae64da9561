//! A window of the system.

use crate::intent::Command;
use crate::platform::Host;

/// A desktop, which leaves all commands and their keys to the program.
#[derive(Debug)]
pub enum Desktop {}

impl Host for Desktop {
    const NOTE: Option<&'static str> = None;

    fn offers(_: Command) -> bool {
        true
    }

    fn has_key(_: Command) -> bool {
        true
    }
}
