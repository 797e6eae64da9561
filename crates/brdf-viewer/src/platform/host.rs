//! What the surroundings leave to the program.

use crate::intent::Command;

/// The commands and the keys that the program has in its surroundings.
pub trait Host {
    /// What the user should know of the surroundings, in one sentence.
    const NOTE: Option<&'static str>;

    /// Whether a command has a meaning.
    fn offers(command: Command) -> bool;

    /// Whether the key of a command reaches the program.
    fn has_key(command: Command) -> bool;
}
