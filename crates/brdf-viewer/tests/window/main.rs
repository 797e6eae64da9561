//! Tests of the window without a display: each uses controls by mouse or keyboard, and reads the
//! effect back from the state or from the painted shapes.

mod choice;
mod commands;
mod common;
mod display;
mod files;
mod fitting;
mod limits;
mod parameters;
mod result;
mod session;
mod snapshots;
mod solid;
