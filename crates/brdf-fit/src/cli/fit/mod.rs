//! `brdf fit`: fits scans, and prints or writes the result.

mod arguments;
mod cube;
mod output;
mod run;
mod settings;
mod values;

pub(super) use arguments::Arguments;
pub(super) use run::run;
