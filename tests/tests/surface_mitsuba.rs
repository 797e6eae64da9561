//! The surface of the viewer against a rendering of the exported plugin by Mitsuba: a ball and a plate, with
//! a lamp far away and a uniform sky. Skipped where there is no Python with mitsuba, or no LLVM for it.
//!
//! `SURFACE_PICTURES=FOLDER` writes what `tests/python/surface_picture.py` draws.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use brdf_core::published::PUBLISHED;
use brdf_core::{AnyBrdf, Family, ModelParameters};
use brdf_fit::export::{ExportOptions, Target, export};
use brdf_fit::plot::{Ground, Quantity, Scale};
use brdf_fit::{AssumedErrors, FitOptions, Measurements, RefractiveIndex, Weights, fit};
use brdf_tests::{in_workspace, made_up_material, one_wavelength, run_python, shared_data};
use brdf_viewer::solid::surface::{
    Composition, Light, Pixels, Radiance, Sky, automatic_stops, lamp_direction, shade,
    stops_for_highlights,
};
use brdf_viewer::solid::{Camera, LobeScene, Spot, direction, lobe_figure};
use serde_json::{Value, json};

/// A relative difference that is not noise: that of the interpolated sky, and of the mean over the finer
/// pixels.
const TOLERANCE: f64 = 0.005;

/// How finely pictures are drawn.
#[derive(Clone, Copy)]
struct Fineness {
    /// Pixels along the width of Mitsuba's picture.
    width: usize,
    /// Pixels of the viewer along a pixel of Mitsuba, which is the mean over its area.
    finer: usize,
    /// Samples of a pixel in each of [`PICTURES`].
    samples: usize,
    /// Standard errors by which a value may differ, by chance in less than a hundredth of the runs.
    sigmas: f64,
}

const COARSE: Fineness = Fineness {
    width: 24,
    finer: 16,
    samples: 64,
    sigmas: 5.5,
};

const FINE: Fineness = Fineness {
    width: 200,
    finer: 8,
    samples: 32,
    sigmas: 7.0,
};

/// The number of Mitsuba's pictures, from whose scatter their standard error follows.
const PICTURES: usize = 64;

/// What the lamp shines on.
#[derive(Clone, Copy)]
enum Body {
    /// The direction of the lamp: to the right and upwards, in radians.
    Ball([f64; 2]),
    /// The zenith angle of the lamp behind the plate in radians.
    Plate(f64),
}

impl Body {
    fn name(self) -> &'static str {
        match self {
            Self::Ball(_) => "ball",
            Self::Plate(_) => "plate",
        }
    }

    fn size(self, width: usize) -> [usize; 2] {
        match self {
            Self::Ball(_) => [width, width],
            Self::Plate(_) => [width, width / 2],
        }
    }

    fn lamp(self) -> [f64; 3] {
        match self {
            Self::Ball(angles) => lamp_direction(angles),
            Self::Plate(psi) => [0.0, psi.sin(), psi.cos()],
        }
    }

    fn pixels(self, width: usize) -> Pixels {
        match self {
            Self::Ball(_) => Pixels::ball(width, self.lamp()),
            Self::Plate(psi) => Pixels::plate(width, psi),
        }
    }
}

/// A surface under light, with the BRDFs of red, green and blue.
#[derive(Clone, Copy)]
struct Scene {
    colours: [AnyBrdf; 3],
    body: Body,
    light: Light,
}

fn brdf(family: Family, [k2, kd, k1, n]: [f64; 4]) -> AnyBrdf {
    AnyBrdf::new(
        family,
        &ModelParameters {
            k2,
            kd,
            k1,
            n,
            p: 1.0,
        },
    )
    .unwrap()
}

/// A scene as a step of the job of `mitsuba_bsdf.py`, with its plugin in a folder.
fn step(scene: &Scene, index: usize, fineness: Fineness, folder: &Path) -> Value {
    let name = format!("surface_{index}");
    let plugin = folder.join(format!("{name}.py"));
    let options = ExportOptions {
        name,
        ..ExportOptions::default()
    };
    let mut text = Vec::new();
    let material = made_up_material(&scene.colours);
    export(&material, Target::Mitsuba, &options, &mut text).unwrap();
    fs::write(&plugin, text).unwrap();
    json!({
        "do": "surface", "path": plugin, "body": scene.body.name(), "size": scene.body.size(fineness.width),
        "lamp": scene.body.lamp(), "irradiance": PI * f64::from(scene.light.lamp),
        "sky": f64::from(scene.light.sky), "spp": fineness.samples, "pictures": PICTURES,
    })
}

/// Mitsuba's picture of each scene: the mean of each value, its standard error, and the share of each pixel
/// that is covered.
fn rendered(scenes: &[Scene], fineness: Fineness) -> Option<Vec<Value>> {
    let folder = tempfile::tempdir().unwrap();
    let steps = scenes.iter().enumerate();
    let steps: Vec<Value> = steps
        .map(|(i, scene)| step(scene, i, fineness, folder.path()))
        .collect();
    let job = json!({ "variant": "llvm_ad_rgb", "steps": steps });
    let found = run_python("mitsuba", "mitsuba_bsdf.py", &job)?;
    Some(found.as_array().unwrap().clone())
}

fn numbers(value: &Value) -> Vec<f64> {
    let array = value.as_array().unwrap().iter();
    array.map(|number| number.as_f64().unwrap()).collect()
}

/// The viewer's picture, averaged over the pixels of Mitsuba; `None` where the edge crosses one.
fn shaded(scene: &Scene, Fineness { width, finer, .. }: Fineness) -> Vec<Option<f64>> {
    let [columns, rows] = scene.body.size(width);
    let pixels = scene.body.pixels(columns * finer);
    let mut sums = vec![(0.0, 0); columns * rows * 3];
    for (channel, brdf) in scene.colours.iter().enumerate() {
        let radiance = shade(&pixels, brdf, &Sky::new(brdf), scene.light);
        for (pixel, value) in radiance.covered(&pixels) {
            let (row, column) = (
                pixel / pixels.size[0] / finer,
                pixel % pixels.size[0] / finer,
            );
            let (sum, count) = &mut sums[(row * columns + column) * 3 + channel];
            *sum += f64::from(value);
            *count += 1;
        }
    }
    let all = sums.into_iter();
    all.map(|(sum, count)| (count == finer * finer).then(|| sum / (finer * finer) as f64))
        .collect()
}

/// Compares the viewer with Mitsuba, and says by how much they differ.
fn compare(name: &str, scene: &Scene, found: &Value, fineness: Fineness) {
    let (means, errors) = (numbers(&found["mean"]), numbers(&found["error"]));
    let values = means.len();
    let (mut compared, mut largest, mut squares) = (0, 0.0_f64, 0.0);
    let (mut differences, mut of_means, mut of_errors) = (0.0, 0.0, 0.0);
    for ((shaded, mean), error) in shaded(scene, fineness).into_iter().zip(means).zip(errors) {
        let Some(shaded) = shaded else {
            continue;
        };
        let off = (shaded - mean).abs() / (error + TOLERANCE * mean.max(1e-3) / fineness.sigmas);
        (compared, largest, squares) = (compared + 1, largest.max(off), squares + off * off);
        differences += (shaded - mean).powi(2);
        of_means += mean * mean;
        of_errors += error * error;
    }
    let rms = (squares / f64::from(compared)).sqrt();
    let percent = |sum: f64| 100.0 * (sum / of_means).sqrt();
    println!(
        "{name}, {}: {compared} values, largest difference {largest:.2} sigma, rms {rms:.2}; rms {:.2} % of \
         that of the values, noise {:.2} %",
        scene.body.name(),
        percent(differences),
        percent(of_errors)
    );
    assert!(
        4 * usize::try_from(compared).unwrap() > values,
        "{compared}"
    );
    assert!(largest < fineness.sigmas && rms < 1.5, "{largest} {rms}");
}

#[test]
fn a_ball_and_a_plate_in_a_lamp_and_a_sky_are_those_of_mitsuba() {
    // A rough paint, a gloss and a satin.
    let colours = [
        brdf(Family::Paper, [0.05, 0.3, 0.4, 1.5]),
        brdf(Family::Ggx, [0.3, 0.1, 0.12, 1.6]),
        brdf(Family::Smith, [0.2, 0.02, 0.25, 1.4]),
    ];
    let bodies = [Body::Ball([0.6, 0.5]), Body::Plate(1.3)];
    let lights = [(1.0, 0.0), (0.0, 1.0), (0.75, 0.25)].map(|(lamp, sky)| Light { lamp, sky });
    let scenes: Vec<Scene> = bodies
        .iter()
        .flat_map(|body| {
            lights.map(|light| Scene {
                colours,
                body: *body,
                light,
            })
        })
        .collect();
    let Some(found) = rendered(&scenes, COARSE) else {
        return;
    };
    for (scene, found) in scenes.iter().zip(&found) {
        compare("made up", scene, found, COARSE);
    }
}

/// A material of the documentation.
struct Sample {
    name: &'static str,
    /// What it is, and its parameters.
    title: String,
    /// The BRDFs of red, green and blue, which are equal where the material is grey.
    colours: [AnyBrdf; 3],
    /// The incidence of its lobe in degrees, and how values are radii.
    lobe: (f64, Scale),
    /// The readings of the middle wavelength.
    scan: Option<Measurements>,
}

/// The paper's model as a text.
fn parameters(at: &ModelParameters) -> String {
    let ModelParameters { k2, kd, k1, n, .. } = at;
    format!("k2 = {k2:.3}, kD = {kd:.3}, k1 = {k1:.4}, n = {n}")
}

/// A measured sample at its wavelengths for red, green and blue: the paper's model with n = 1.5.
fn measured(
    name: &'static str,
    path: &Path,
    um: [f64; 3],
    errors: AssumedErrors,
    lobe: (f64, Scale),
) -> Sample {
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        weights: Weights {
            errors,
            ..Weights::default()
        },
        ..FitOptions::default()
    };
    let scans = um.map(|um| one_wavelength(path, um));
    let fitted = scans
        .each_ref()
        .map(|scan| fit(scan, &options).unwrap().at());
    let colours = if um[0] == um[2] {
        format!("{} µm", um[1])
    } else {
        format!("{}, {}, {} µm; at {}", um[0], um[1], um[2], um[1])
    };
    let [_, scan, _] = scans;
    Sample {
        name,
        title: format!("{name}, {colours}: {}", parameters(&fitted[1])),
        colours: fitted.map(|at| AnyBrdf::new(Family::Paper, &at).unwrap()),
        lobe,
        scan: Some(scan),
    }
}

/// A black paint, an anodised metal, a row of Table 1 of the paper, and, where it is at hand, a glossy white.
fn samples() -> Vec<Sample> {
    let ours = |name, file: &str, um| {
        let path = in_workspace("data/measured").join(file);
        let lobe = (50.0, Scale::Linear);
        measured(name, &path, [um; 3], AssumedErrors::Constant, lobe)
    };
    let row = &PUBLISHED[0];
    let at = ModelParameters::three(row.parameters, row.n);
    let mut samples = vec![
        ours("Z307", "z307_on_aluminium.csv", 0.63079),
        ours("titanium anodise", "titanium_anodise.csv", 0.38565),
        Sample {
            name: "Table 1, 001",
            title: format!(
                "Table 1, 001, {} µm: {}",
                row.wavelength_um,
                parameters(&at)
            ),
            colours: [AnyBrdf::new(Family::Paper, &at).unwrap(); 3],
            lobe: (50.0, Scale::Linear),
            scan: None,
        },
    ];
    if let Some(folder) = shared_data() {
        let path = folder.join("ansys/glossy_white.csv");
        // Constant errors let the peak at large incidences decide on the white.
        let errors = AssumedErrors::Relative;
        let lobe = (40.0, Scale::Logarithmic);
        samples.push(measured(
            "glossy white",
            &path,
            [0.61, 0.55, 0.46],
            errors,
            lobe,
        ));
    }
    samples
}

/// The light of the viewer after its first start.
fn bodies() -> [Body; 2] {
    [
        Body::Ball([35_f64.to_radians(); 2]),
        Body::Plate(75_f64.to_radians()),
    ]
}

const LIGHT: Light = Light {
    lamp: 0.75,
    sky: 0.25,
};

#[test]
fn samples_are_those_of_mitsuba() {
    let folder = std::env::var_os("SURFACE_PICTURES");
    let fineness = if folder.is_some() { FINE } else { COARSE };
    let samples = samples();
    let scenes = |sample: &Sample| {
        bodies().map(|body| Scene {
            colours: sample.colours,
            body,
            light: LIGHT,
        })
    };
    let all: Vec<Scene> = samples.iter().flat_map(scenes).collect();
    let Some(found) = rendered(&all, fineness) else {
        return;
    };
    if let Some(folder) = folder {
        write(&samples, &found, Path::new(&folder));
    }
    for (i, (scene, found)) in all.iter().zip(&found).enumerate() {
        compare(samples[i / 2].name, scene, found, fineness);
    }
}

/// Writes the lobes as PNG, and what `surface_picture.py` shows beside them as JSON.
fn write(samples: &[Sample], found: &[Value], folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    let rows = samples.iter().zip(found.chunks(2));
    let rows = rows.enumerate().map(|(i, (sample, found))| {
        let (caption, lobe) = (lobe_caption(sample), folder.join(format!("lobe-{i}.png")));
        fs::write(&lobe, lobe_png(sample)).unwrap();
        let (picture, stops) = viewer_picture(sample);
        json!({
            "title": sample.title, "caption": caption, "lobe": lobe, "stops": stops, "viewer": picture,
            "ball": found[0], "plate": found[1], "width": FINE.width,
        })
    });
    let rows: Vec<Value> = rows.collect();
    fs::write(folder.join("surfaces.json"), json!(rows).to_string()).unwrap();
}

fn lobe_png(sample: &Sample) -> Vec<u8> {
    let (psi_deg, scale) = sample.lobe;
    let scan = sample.scan.iter();
    let incidences = scan.flat_map(Measurements::readings);
    let at_psi = incidences.filter(|reading| (reading.psi.to_degrees() - psi_deg).abs() < 0.01);
    let readings = at_psi.map(|reading| Spot {
        direction: direction(reading.theta, reading.phi),
        value: Quantity::BrdfCosine.of(reading.brdf, reading.theta.cos()),
        left_out: false,
    });
    let scene = LobeScene::new(
        (&sample.colours[1], None),
        psi_deg.to_radians(),
        (Quantity::BrdfCosine, scale),
        readings.collect(),
    );
    let figure = lobe_figure(&scene, &Camera::default(), ["", ""], Ground::Light);
    figure.png(1.0).unwrap()
}

fn lobe_caption(sample: &Sample) -> String {
    let (psi_deg, scale) = sample.lobe;
    let radius = match scale {
        Scale::Linear => "linear",
        Scale::Logarithmic => "logarithmic",
    };
    format!("f_r cos θ / (1/sr) at ψ = {psi_deg}°, {radius} radius")
}

/// The viewer's picture of the ball above the plate as it is exported: red, green and blue of each pixel, and
/// the exposures of both in stops.
fn viewer_picture(sample: &Sample) -> (Vec<[u8; 3]>, [f64; 2]) {
    let skies: Vec<Sky> = sample.colours.iter().map(Sky::new).collect();
    let plate = bodies()[1].pixels(FINE.width);
    let both = sample.colours.iter().zip(&skies);
    let highlights: Vec<Radiance> = both
        .map(|(brdf, sky)| shade(&plate, brdf, sky, LIGHT))
        .collect();
    let stops = [
        automatic_stops(skies.iter()),
        stops_for_highlights(highlights.iter()),
    ];
    let composition = Composition {
        surfaces: vec![sample.colours.to_vec()],
        lamp: [35_f64.to_radians(); 2],
        plate_psi: 75_f64.to_radians(),
        light: LIGHT,
        stops,
        ground: Ground::Light,
    };
    let picture = composition.picture(FINE.width);
    let pixels = picture
        .pixels
        .iter()
        .map(|pixel| [pixel.r(), pixel.g(), pixel.b()]);
    (pixels.collect(), stops)
}
