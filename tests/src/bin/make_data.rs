//! Writes what the project generates: Table 1, the synthetic scans, and the picture of the README.

use std::error::Error;
use std::fs;

use brdf_tests::{data, in_workspace, picture};

fn main() -> Result<(), Box<dyn Error>> {
    let mut files = data::files();
    files.push(("docs/z307.svg".to_owned(), picture::svg()?));
    for (path, text) in files {
        let target = in_workspace(&path);
        if let Some(folder) = target.parent() {
            fs::create_dir_all(folder)?;
        }
        fs::write(target, text)?;
        println!("{path}");
    }
    Ok(())
}
