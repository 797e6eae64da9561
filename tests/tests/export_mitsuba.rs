//! The exported Mitsuba plugin in the real Mitsuba: against the core, by Mitsuba's own chi-square
//! test of sampling, and as a picture. Skipped where there is no Python with mitsuba, and, for the
//! variant `llvm_ad_rgb`, where there is no LLVM that Dr.Jit can use.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters, Sampler};
use brdf_fit::export::Material;
use brdf_tests::{
    export_command, generator, in_workspace, made_up_material, python, run_fit, run_python,
};
use nalgebra::Vector3;
use rand::RngExt;
use rand::rngs::StdRng;
use serde_json::{Value, json};
use tempfile::TempDir;

const SCALAR: &str = "scalar_rgb";
const LLVM: &str = "llvm_ad_rgb";

/// The exported plugins of a test, each under a name of its own.
struct Plugins {
    folder: TempDir,
}

impl Plugins {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Exports the BRDFs of one wavelength or of three.
    fn export(&self, name: &str, brdfs: &[AnyBrdf]) -> PathBuf {
        let plugin = self.path(&format!("{name}.py"));
        let output = self.try_export(&made_up_material(brdfs), &["--name", name], &plugin);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        plugin
    }

    fn try_export(&self, material: &Material, options: &[&str], plugin: &Path) -> Output {
        let fits = self.path("fits.json");
        let mut bytes = Vec::new();
        material.write(&mut bytes).unwrap();
        fs::write(&fits, bytes).unwrap();
        let mut command = export_command();
        command.arg(&fits).args(["--to", "mitsuba"]).args(options);
        command.arg("-o").arg(plugin).output().unwrap()
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What Mitsuba finds in a variant, step by step. `None`, and "skipped" on standard output, where
/// there is no Mitsuba or no LLVM for it.
fn mitsuba(variant: &str, steps: &[Value]) -> Option<Vec<Value>> {
    let job = json!({ "variant": variant, "steps": steps });
    let found = run_python("mitsuba", "mitsuba_bsdf.py", &job)?;
    Some(found.as_array().unwrap().clone())
}

fn numbers(value: &Value) -> Vec<f64> {
    let array = value.as_array().unwrap().iter();
    array.map(|number| number.as_f64().unwrap()).collect()
}

fn brdf(family: Family, [k2, kd, k1, n, p]: [f64; 5]) -> AnyBrdf {
    AnyBrdf::new(family, &ModelParameters { k2, kd, k1, n, p }).unwrap()
}

/// All families, from narrow to broad.
fn of_all_families(widths: &[f64]) -> Vec<(String, AnyBrdf)> {
    let mut all = Vec::new();
    for family in Family::ALL {
        for (i, &k1) in widths.iter().enumerate() {
            let n = [1.5, 1.1, 1.0, 2.4][i % 4];
            let p = [0.4, 1.0, 1.3, 4.0][i % 4];
            let name = format!("{family:?}{i}").to_lowercase();
            all.push((name, brdf(family, [0.3, 0.1, k1, n, p])));
        }
    }
    all
}

/// A material whose colours differ in everything.
fn colourful() -> [AnyBrdf; 3] {
    [
        brdf(Family::Paper, [0.6, 0.05, 0.09, 1.5, 1.0]),
        brdf(Family::Ggx, [0.6, 0.12, 0.15, 1.6, 1.0]),
        brdf(Family::Power, [0.5, 0.35, 0.3, 1.4, 2.0]),
    ]
}

fn direction(zenith: f64, azimuth: f64) -> [f64; 3] {
    let (sin, cos) = azimuth.sin_cos();
    rounded([zenith.sin() * cos, zenith.sin() * sin, zenith.cos()])
}

/// In single precision, as in Mitsuba.
fn rounded(direction: [f64; 3]) -> [f64; 3] {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "the function rounds to single precision"
    )]
    direction.map(|x| f64::from(x as f32))
}

/// Pairs of directions above the surface: half at random, half as the sampler draws them.
fn pairs(brdf: &AnyBrdf, count: usize, random: &mut StdRng) -> Vec<[[f64; 3]; 2]> {
    let sampler = Sampler::new(brdf);
    let mut found = Vec::new();
    while found.len() < count {
        let zenith = |random: &mut StdRng| random.random_range(0.0..1.55);
        let source = direction(zenith(random), random.random_range(0.0..6.0));
        let view = direction(zenith(random), random.random_range(0.0..6.0));
        found.push([source, view]);
        let unit = Vector3::from(source).normalize();
        if let Some(sample) = sampler.sample(unit, random.random()).unwrap() {
            found.push([source, rounded(sample.direction)]);
        }
    }
    found
}

fn geometry([source, view]: &[[f64; 3]; 2]) -> Geometry {
    let unit = |direction: &[f64; 3]| Vector3::from(*direction).normalize();
    Geometry::from_directions(unit(source), unit(view)).unwrap()
}

/// The largest error of Mitsuba's results, as a multiple of the tolerance: at most 1 in a passing test.
/// The tolerance is 1e-5 of the value. That of the density includes the rounding error of its weights,
/// which is not small in comparison with 1 - w_s where that is small. (Directions are drawn with the
/// same rounded weight.)
fn excess(found: &Value, channels: &[AnyBrdf; 3], pairs: &[[[f64; 3]; 2]]) -> f64 {
    let geometries: Vec<_> = pairs.iter().map(geometry).collect();
    let mut largest: f64 = 0.0;
    let mut compare = |found: &Value, expected: &[f64], rounding: f64| {
        for ((f, e), geometry) in numbers(found).iter().zip(expected).zip(&geometries) {
            let allowed = 1e-5 * e + rounding * geometry.cos_theta() / PI;
            largest = largest.max((f - e).abs() / allowed);
        }
    };
    for (values, brdf) in found["channels"].as_array().unwrap().iter().zip(channels) {
        let expected = geometries.iter().map(|g| brdf.value(g) * g.cos_theta());
        compare(values, &expected.collect::<Vec<_>>(), 0.0);
    }
    let samplers = channels.map(|brdf| Sampler::new(&brdf));
    let density = |[source, view]: &[[f64; 3]; 2]| {
        let [source, view] = [source, view].map(|d| Vector3::from(*d).normalize());
        let of_each = samplers.iter().map(|s| s.pdf(source, view).unwrap());
        of_each.sum::<f64>() / 3.0
    };
    let expected: Vec<_> = pairs.iter().map(density).collect();
    compare(&found["pdf"], &expected, 4.0 * f64::from(f32::EPSILON));
    largest
}

#[test]
fn values_and_densities_are_those_of_the_core() {
    let (plugins, mut random) = (Plugins::new(), generator(1));
    let mut cases = Vec::new();
    for (name, brdf) in of_all_families(&[0.003, 0.05, 0.4, 1.0, 2.5]) {
        cases.push((plugins.export(&name, &[brdf]), [brdf; 3]));
    }
    cases.push((plugins.export("colourful", &colourful()), colourful()));
    let pairs: Vec<_> = cases
        .iter()
        .map(|(_, channels)| pairs(&channels[0], 300, &mut random))
        .collect();
    let steps = cases.iter().zip(&pairs).map(|((plugin, _), pairs)| {
        let column = |i: usize| pairs.iter().map(|pair| pair[i]).collect::<Vec<_>>();
        json!({ "do": "points", "path": plugin, "wi": column(0), "wo": column(1) })
    });
    let steps: Vec<_> = steps.collect();
    for variant in [SCALAR, LLVM] {
        for (i, found) in mitsuba(variant, &steps).into_iter().flatten().enumerate() {
            let (plugin, channels) = &cases[i];
            let excess = excess(&found, channels, &pairs[i]);
            println!("{variant} {}: {excess:.2}", plugin.display());
            assert!(excess < 1.0, "{variant} {}: {excess}", plugin.display());
        }
    }
}

#[test]
fn mono_is_the_luminance_and_a_spectrum_goes_through_the_colours() {
    let plugins = Plugins::new();
    let plugin = plugins.export("colourful", &colourful());
    let pair = [direction(0.5, 0.0), direction(0.7, 3.0)];
    let geometry = geometry(&pair);
    let [red, green, blue] = colourful().map(|brdf| brdf.value(&geometry) * geometry.cos_theta());
    let luminance = 0.212_671 * red + 0.715_160 * green + 0.072_169 * blue;
    let spectrum = vec![blue, blue, green, 0.5 * (green + red)];
    let step = json!({
        "do": "points", "path": plugin, "wi": [pair[0]], "wo": [pair[1]],
        "wavelengths": [400.0, 464.0, 549.0, 580.0],
    });
    let cases = [
        ("llvm_ad_mono", vec![luminance]),
        ("scalar_spectral", spectrum.clone()),
        ("llvm_ad_spectral", spectrum),
    ];
    for (variant, expected) in cases {
        for found in mitsuba(variant, std::slice::from_ref(&step))
            .into_iter()
            .flatten()
        {
            let channels = found["channels"].as_array().unwrap();
            assert_eq!(channels.len(), expected.len(), "{variant}");
            for (channel, expected) in channels.iter().zip(&expected) {
                let value = numbers(channel)[0];
                assert!(
                    (value / expected - 1.0).abs() < 1e-5,
                    "{variant}: {value} {expected}"
                );
            }
        }
    }
}

#[test]
fn nothing_is_reflected_from_or_to_below_the_surface() {
    let plugins = Plugins::new();
    let plugin = plugins.export("colourful", &colourful());
    let (above, below, flat) = ([0.6, 0.0, 0.8], [0.6, 0.0, -0.8], [1.0, 0.0, 0.0]);
    let (wi, wo) = (
        [above, below, below, flat, above],
        [below, above, below, above, flat],
    );
    let step = json!({ "do": "points", "path": plugin, "wi": wi, "wo": wo });
    for variant in [SCALAR, LLVM] {
        for found in mitsuba(variant, std::slice::from_ref(&step))
            .into_iter()
            .flatten()
        {
            let columns = found["channels"].as_array().unwrap().iter();
            for column in columns.chain([&found["pdf"]]) {
                assert_eq!(numbers(column), [0.0; 5], "{variant}");
            }
        }
    }
}

/// A step of Mitsuba's chi-square test at an incidence in degrees.
fn chi_square(plugin: &Path, pdf_of: &Path, psi_deg: f64, component: Option<u32>) -> Value {
    let wi = direction(f64::to_radians(psi_deg), 0.4);
    json!({
        "do": "chi2", "path": plugin, "pdf_of": pdf_of, "wi": wi, "component": component,
    })
}

/// Runs chi-square tests at a level of 1 % for all of them together.
fn run_chi_square(mut steps: Vec<Value>) -> Vec<Value> {
    let tests = steps.len();
    for (seed, step) in steps.iter_mut().enumerate() {
        step["tests"] = json!(tests);
        step["seed"] = json!(seed);
    }
    let found = mitsuba(LLVM, &steps).unwrap_or_default();
    for (step, found) in steps.iter().zip(&found) {
        println!("{} at {}: p = {}", step["path"], step["wi"], found["p"]);
    }
    found
}

#[test]
fn sampling_passes_the_chi_square_test_of_mitsuba() {
    let plugins = Plugins::new();
    let mut steps = Vec::new();
    for (name, brdf) in of_all_families(&[0.06, 0.25, 1.0, 2.5]) {
        let plugin = plugins.export(&name, &[brdf]);
        let at = |psi_deg| chi_square(&plugin, &plugin, psi_deg, None);
        steps.extend([0.0, 30.0, 60.0, 85.0].map(at));
    }
    for found in run_chi_square(steps) {
        assert_eq!(found["accepted"], true, "{}", found["words"]);
    }
}

#[test]
fn the_mixture_and_each_of_its_components_pass_the_chi_square_test() {
    let plugins = Plugins::new();
    let plugin = plugins.export("colourful", &colourful());
    let steps = [None, Some(0), Some(1)].into_iter().flat_map(|component| {
        let at = |psi_deg| chi_square(&plugin, &plugin, psi_deg, component);
        [0.0, 45.0, 80.0].map(at)
    });
    for found in run_chi_square(steps.collect()) {
        assert_eq!(found["accepted"], true, "{}", found["words"]);
    }
}

#[test]
fn the_chi_square_test_sees_a_density_that_is_wrong() {
    let plugins = Plugins::new();
    let mut steps = Vec::new();
    for family in Family::ALL {
        let of_width = |k1: f64, suffix| {
            let name = format!("{family:?}{suffix}").to_lowercase();
            plugins.export(&name, &[brdf(family, [0.3, 0.1, k1, 1.5, 1.3])])
        };
        let (plugin, wider) = (of_width(0.25, "a"), of_width(0.3, "b"));
        steps.push(chi_square(&plugin, &wider, 30.0, None));
    }
    for found in run_chi_square(steps) {
        assert_eq!(found["accepted"], false, "{}", found["words"]);
    }
}

#[test]
fn the_mean_weight_is_the_hemispherical_reflectance() {
    let plugins = Plugins::new();
    let mut cases = Vec::new();
    for (name, brdf) in of_all_families(&[0.06, 0.25, 1.0, 2.5]) {
        cases.push((plugins.export(&name, &[brdf]), [brdf; 3]));
    }
    cases.push((plugins.export("colourful", &colourful()), colourful()));
    for (variant, count, every) in [(SCALAR, 2_000, 5), (LLVM, 1 << 18, 1)] {
        let cases: Vec<_> = cases.iter().step_by(every).collect();
        let all: Vec<_> = cases
            .iter()
            .flat_map(|case| [0.0, 40.0, 75.0_f64].map(|psi_deg| (case, psi_deg)))
            .collect();
        let step = |((plugin, _), psi_deg): &(&&(PathBuf, [AnyBrdf; 3]), f64)| {
            let wi = direction(psi_deg.to_radians(), 0.4);
            json!({ "do": "weights", "path": plugin, "wi": wi, "count": count, "component": null })
        };
        let steps: Vec<_> = all.iter().map(step).collect();
        let found = mitsuba(variant, &steps).unwrap_or_default();
        for (((plugin, channels), psi_deg), found) in all.iter().zip(&found) {
            let (means, errors) = (numbers(&found["mean"]), numbers(&found["error"]));
            for (i, brdf) in channels.iter().enumerate() {
                let psi = psi_deg.to_radians();
                let expected = brdf.hemispherical_reflectance(psi, 1e-6).unwrap();
                let off = (means[i] - expected).abs() / (4.5 * errors[i] + 1e-5 * expected);
                let name = plugin.display();
                assert!(
                    off < 1.0,
                    "{variant} {name} {psi_deg}: {} {expected}",
                    means[i]
                );
                assert!(
                    errors[i] < 0.1 * expected,
                    "{variant} {name} {psi_deg}: noise"
                );
            }
        }
    }
}

/// Runs an exported plugin as a program.
fn render(plugin: &Path, arguments: &[&str]) -> Option<Output> {
    let mut command = Command::new(python("mitsuba")?);
    Some(command.arg(plugin).args(arguments).output().unwrap())
}

#[test]
fn the_scene_shows_the_material_and_its_highlight() {
    let plugins = Plugins::new();
    let plugin = plugins.export("colourful", &colourful());
    let scene = plugin.with_extension("xml");
    // The highlight of the light in front, a part of the sphere away from it, the ground.
    let parts = [
        [0.39, 0.37, 0.43, 0.41],
        [0.5, 0.7, 0.6, 0.8],
        [0.0, 0.9, 1.0, 1.0],
    ];
    for (variant, spp) in [(SCALAR, "8"), (LLVM, "64")] {
        let picture = plugins.path(&format!("{variant}.exr"));
        let (scene, path) = (scene.to_str().unwrap(), picture.to_str().unwrap());
        let arguments = [
            scene,
            path,
            "--spp",
            spp,
            "--size",
            "64",
            "--variant",
            variant,
        ];
        let step = json!({ "do": "picture", "path": path, "parts": parts });
        // Says so where there is no Mitsuba, or no LLVM.
        if mitsuba(variant, &[]).is_none() {
            continue;
        }
        let output = render(&plugin, &arguments).unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let found = mitsuba(SCALAR, &[step]).unwrap().remove(0);
        assert_eq!(found["size"], json!([64, 64]));
        assert_eq!(found["finite"], true);
        let means: Vec<_> = found["means"]
            .as_array()
            .unwrap()
            .iter()
            .map(numbers)
            .collect();
        println!("{variant}: {means:?}");
        let [highlight, away, ground] = [0, 1, 2].map(|i| &means[i]);
        assert!(
            ground.iter().all(|&value| value > 0.01),
            "the ground is lit"
        );
        assert!(
            away[0] > 0.0 && away[0] < away[1] && away[1] < away[2],
            "it is blue"
        );
        assert!((0..3).all(|i| highlight[i] > 1.5 * away[i]), "it shines");
    }
}

#[test]
fn from_a_scan_to_a_picture_in_three_commands() {
    let plugins = Plugins::new();
    let (fits, plugin) = (plugins.path("fit.json"), plugins.path("material.py"));
    let scan = in_workspace("data/measured/z307_on_aluminium.csv");
    let output = run_fit([
        scan.as_os_str(),
        "--n".as_ref(),
        "1.5".as_ref(),
        "--json".as_ref(),
        fits.as_os_str(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let mut command = export_command();
    command
        .arg(&fits)
        .args(["--to", "mitsuba", "--wavelength", "0.63079", "-o"]);
    let output = command.arg(&plugin).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    if mitsuba(LLVM, &[]).is_none() {
        return;
    }
    let output = render(&plugin, &["--spp", "1", "--size", "16"]).unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let picture = plugin.with_extension("png");
    let message = String::from_utf8(output.stdout).unwrap();
    assert!(
        message.contains(&format!("written: {}", picture.display())),
        "{message}"
    );
    assert!(fs::read(picture).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn two_files_are_written_and_named() {
    let plugins = Plugins::new();
    let plugin = plugins.path("material.py");
    let output = plugins.try_export(&made_up_material(&colourful()), &[], &plugin);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let message = String::from_utf8(output.stdout).unwrap();
    let scene = plugin.with_extension("xml");
    assert_eq!(
        message,
        format!("written: {}, {}\n", plugin.display(), scene.display())
    );
    assert!(
        fs::read_to_string(scene)
            .unwrap()
            .contains("<bsdf type=\"brdf\"/>")
    );
}

#[test]
fn what_cannot_be_written_is_not_written_in_part() {
    let plugins = Plugins::new();
    let plugin = plugins.path("material.py");
    fs::create_dir(plugin.with_extension("xml")).unwrap();
    let output = plugins.try_export(&made_up_material(&colourful()), &[], &plugin);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("material.xml: cannot be written"),
        "{}",
        stderr(&output)
    );
    assert!(!plugin.exists());
}

#[test]
fn bad_usage_is_reported() {
    let plugins = Plugins::new();
    let plugin = plugins.path("material.py");
    let refused = |material: &Material, options: &[&str], plugin: &Path| {
        let output = plugins.try_export(material, options, plugin);
        assert_eq!(output.status.code(), Some(2));
        assert!(!plugin.exists());
        stderr(&output)
    };
    let colourful = made_up_material(&colourful());
    let message = refused(&colourful, &[], &plugins.path("material.xml"));
    assert!(
        message.contains("is an input or another output"),
        "{message}"
    );
    let message = refused(&colourful, &["--rgb", "0.62,0.55"], &plugin);
    assert!(message.contains("expected three numbers"), "{message}");
    let message = refused(&colourful, &["--rgb", "0.62,0.55,0.7"], &plugin);
    assert!(
        message.contains("no fit at 0.7 um: expected one of"),
        "{message}"
    );
    let two = Material {
        fits: colourful.fits[..2].to_vec(),
    };
    let message = refused(&two, &[], &plugin);
    assert!(
        message.contains("no fit within 0.06 um of blue"),
        "{message}"
    );
    let output = plugins.try_export(&two, &["--rgb", "0.62,0.55,0.55"], &plugin);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));

    let mut command = export_command();
    let output = command
        .arg(plugins.path("fits.json"))
        .args(["--to", "mitsuba"]);
    let output = output.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("expected -o FILE"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_polarised_variant_is_refused_with_a_message() {
    let plugins = Plugins::new();
    let plugin = plugins.export("grey", &[colourful()[0]]);
    let Some(output) = render(&plugin, &["--variant", "scalar_spectral_polarized"]) else {
        return;
    };
    assert_eq!(output.status.code(), Some(1));
    assert!(
        stderr(&output).contains("the model has no polarisation"),
        "{}",
        stderr(&output)
    );
}
