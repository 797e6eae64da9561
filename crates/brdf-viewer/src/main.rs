//! The `viewer` program: a window of the desktop, a picture of one, or a page in a browser.

use std::process::ExitCode;

fn main() -> ExitCode {
    brdf_viewer::platform::current::main()
}
