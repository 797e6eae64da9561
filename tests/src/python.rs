//! A Python that has what a test needs.

use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use serde_json::Value;

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

/// What a script of `tests/python` makes of a job, which it reads from standard input; both are JSON.
/// `None`, and "skipped" on standard output, where no Python has the module, and where the script
/// writes null: there is no LLVM that it can use.
pub fn run_python(module: &str, script: &str, job: &Value) -> Option<Value> {
    let mut program = Command::new(python(module)?)
        .arg(in_workspace("tests/python").join(script))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("python starts");
    let (job, input) = (job.to_string(), program.stdin.take());
    let mut input = input.expect("a pipe to python");
    let written = std::thread::spawn(move || input.write_all(job.as_bytes()));
    let output = program.wait_with_output().expect("python ends");
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}");
    let written = written.join().expect("the job is written");
    written.expect("python reads the job");
    let found: Option<Value> = serde_json::from_slice(&output.stdout).expect("JSON");
    if found.is_none() {
        println!("skipped: no LLVM that {script} can use");
    }
    found
}
