//! The window without a display: every control by mouse or keyboard, its effect read back.

mod commands;
mod common;
mod files;
mod fitting;
mod look;
mod snapshots;
mod turn;
