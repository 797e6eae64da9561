//! A Python that has what a test needs.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::in_workspace;

/// A Python that can import a module: the one of the variable `BRDF_PYTHON`, that of the virtual
/// environment `target/python`, or `python3`. `None`, and "skipped" on standard output, where none
/// has it.
pub fn python(module: &str) -> Option<PathBuf> {
    let environment = in_workspace("target/python/bin/python");
    let candidates = std::env::var_os("BRDF_PYTHON").map(PathBuf::from);
    let candidates = candidates
        .into_iter()
        .chain([environment, "python3".into()]);
    let found = candidates.into_iter().find(|python| {
        let import = Command::new(python)
            .args(["-c", &format!("import {module}")])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .status();
        import.is_ok_and(|status| status.success())
    });
    if found.is_none() {
        println!("no python with {module}: skipped");
    }
    found
}
