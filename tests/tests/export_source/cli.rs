//! The program `export`: the sources it writes, and its messages.

use std::fs;
use std::path::{Path, PathBuf};

use brdf_core::{AnyBrdf, Family, ModelParameters};
use brdf_fit::export::{Fitted, Language, Material};
use brdf_tests::export_command;

use crate::materials::source;
use crate::shader::from_glsl;

const LANGUAGES: [(Language, &str); 5] = [
    (Language::C, "c"),
    (Language::Glsl, "glsl"),
    (Language::Wgsl, "wgsl"),
    (Language::Osl, "osl"),
    (Language::Python, "python"),
];

fn brdf(k1: f64) -> AnyBrdf {
    let at = ModelParameters {
        k2: 0.3,
        kd: 0.1,
        k1,
        n: 1.5,
        p: 1.0,
    };
    AnyBrdf::new(Family::Paper, &at).expect("a brdf")
}

/// The fits of wavelengths, in a file.
fn material(folder: &Path, wavelengths_um: &[f64]) -> PathBuf {
    let fits = wavelengths_um.iter().map(|um| Fitted {
        file: "data/scan.csv".to_owned(),
        wavelength_um: Some(*um),
        brdf: brdf(*um),
        e_percent: 1.25,
        psi_max_deg: 70.0,
    });
    let material = Material {
        fits: fits.collect(),
    };
    let mut bytes = Vec::new();
    material.write(&mut bytes).expect("a material");
    let path = folder.join("material.json");
    fs::write(&path, bytes).expect("a file");
    path
}

#[test]
fn a_material_is_written_in_every_language() {
    let folder = tempfile::tempdir().expect("a folder");
    let fits = material(folder.path(), &[0.63]);
    for (language, name) in LANGUAGES {
        let output = export_command().arg(&fits).args(["--to", name]).output();
        let output = output.expect("the program starts");
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        let text = String::from_utf8(output.stdout).expect("text");
        assert_eq!(text, source(&brdf(0.63), language, "brdf"));
    }
}

#[test]
fn several_wavelengths_are_written_one_by_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let fits = material(folder.path(), &[0.45, 0.55, 0.63]);
    let together = export_command().arg(&fits).args(["--to", "glsl"]).output();
    let together = together.expect("the program starts");
    let message = String::from_utf8_lossy(&together.stderr).into_owned();
    assert_eq!(together.status.code(), Some(2));
    assert!(
        message.contains("--wavelength") && message.contains("0.55 um"),
        "{message}"
    );
    let mut text = "#version 450\n".to_owned();
    for (name, wavelength) in [("blue", "0.45"), ("green", "0.55"), ("red", "0.63")] {
        let file = folder.path().join(name);
        let mut export = export_command();
        export
            .arg(&fits)
            .args(["--to", "glsl", "--name", name, "--wavelength", wavelength]);
        let status = export
            .arg("-o")
            .arg(&file)
            .status()
            .expect("the program starts");
        assert!(status.success());
        text += &fs::read_to_string(&file).expect("the file is written");
    }
    text +=
        "layout(location = 0) out vec4 color;\nvoid main() {\n    vec3 up = vec3(0.0, 0.0, 1.0);\n";
    text += "    color = vec4(red_eval(up, up), green_eval(up, up), blue_eval(up, up), 1.0);\n}\n";
    from_glsl(&text);
}

#[test]
fn a_name_that_is_no_identifier_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let fits = material(folder.path(), &[0.63]);
    for name in [
        "",
        "2k",
        "a b",
        "gl",
        "gl_paint",
        "a__b",
        "paint_",
        "_paint",
        "n\u{e4}me",
        "a-b",
    ] {
        let output = export_command()
            .arg(&fits)
            .args(["--to", "c", "--name", name])
            .output();
        let output = output.expect("the program starts");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(
            message.contains("is not a name in source code"),
            "{message}"
        );
    }
}
