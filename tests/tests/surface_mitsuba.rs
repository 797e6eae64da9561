//! The surface of the viewer against a rendering of the exported plugin by Mitsuba: a ball with a lamp
//! far away and a uniform sky. Skipped where there is no Python with mitsuba, or no LLVM for it.

use brdf_core::{AnyBrdf, Family, ModelParameters};
use brdf_fit::export::{ExportOptions, Target, export};
use brdf_tests::{made_up_material, run_python};
use brdf_viewer::solid::surface::{Light, Pixels, Sky, lamp_direction, shade};
use serde_json::{Value, json};

/// Pixels along a side of Mitsuba's picture.
const SIDE: usize = 24;

/// Pixels of the viewer along a pixel of Mitsuba, which is the mean over its area.
const FINER: usize = 16;

/// Standard errors by which a pixel may differ: of 3000 values the largest is beyond 4.5 by chance in a
/// hundredth of the runs.
const SIGMAS: f64 = 5.0;

/// A relative difference that is not noise: that of the interpolated sky, and of the mean over the finer
/// pixels.
const TOLERANCE: f64 = 0.005;

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

/// The fit of red, green and blue: a rough paint, a gloss and a satin.
fn colours() -> [AnyBrdf; 3] {
    [
        brdf(Family::Paper, [0.05, 0.3, 0.4, 1.5]),
        brdf(Family::Ggx, [0.3, 0.1, 0.12, 1.6]),
        brdf(Family::Smith, [0.2, 0.02, 0.25, 1.4]),
    ]
}

/// Mitsuba's picture: the mean of each value and its standard error, row by row.
fn rendered(lamp: [f64; 3], light: Light) -> Option<[Vec<f64>; 2]> {
    let folder = tempfile::tempdir().unwrap();
    let plugin = folder.path().join("ball.py");
    let options = ExportOptions {
        name: "ball".to_owned(),
        ..ExportOptions::default()
    };
    let mut text = Vec::new();
    export(
        &made_up_material(&colours()),
        Target::Mitsuba,
        &options,
        &mut text,
    )
    .unwrap();
    std::fs::write(&plugin, text).unwrap();
    let step = json!({
        "do": "ball", "path": plugin, "side": SIDE, "lamp": lamp,
        "irradiance": std::f64::consts::PI * f64::from(light.lamp),
        "sky": f64::from(light.sky), "spp": 256, "pictures": 16,
    });
    let job = json!({ "variant": "llvm_ad_rgb", "steps": [step] });
    let found = run_python("mitsuba", "mitsuba_bsdf.py", &job)?;
    let numbers = |value: &Value| -> Vec<f64> {
        let array = value.as_array().unwrap().iter();
        array.map(|number| number.as_f64().unwrap()).collect()
    };
    Some(["mean", "error"].map(|name| numbers(&found[0][name])))
}

/// The viewer's picture, averaged over the pixels of Mitsuba; `None` where the limb crosses one.
fn shaded(lamp: [f64; 3], light: Light) -> Vec<Option<f64>> {
    let fine = SIDE * FINER;
    let pixels = Pixels::ball(fine, lamp);
    let mut sums = vec![(0.0, 0); SIDE * SIDE * 3];
    for (channel, brdf) in colours().iter().enumerate() {
        let radiance = shade(&pixels, brdf, &Sky::new(brdf), light);
        for (pixel, value) in radiance.covered(&pixels) {
            let (row, column) = (pixel / fine / FINER, pixel % fine / FINER);
            let (sum, count) = &mut sums[(row * SIDE + column) * 3 + channel];
            *sum += f64::from(value);
            *count += 1;
        }
    }
    let all = sums.into_iter();
    all.map(|(sum, count)| (count == FINER * FINER).then(|| sum / (FINER * FINER) as f64))
        .collect()
}

fn compare(lamp: [f64; 3], light: Light) {
    let Some([means, errors]) = rendered(lamp, light) else {
        return;
    };
    let (mut compared, mut largest, mut squares) = (0, 0.0_f64, 0.0);
    for ((shaded, mean), error) in shaded(lamp, light).into_iter().zip(means).zip(errors) {
        let Some(shaded) = shaded else {
            continue;
        };
        let off = (shaded - mean).abs() / (error + TOLERANCE * mean.max(1e-3) / SIGMAS);
        (compared, largest, squares) = (compared + 1, largest.max(off), squares + off * off);
    }
    let rms = (squares / f64::from(compared)).sqrt();
    println!("{compared} values, largest difference {largest:.2} sigma, rms {rms:.2}");
    assert!(compared > 900, "{compared}");
    assert!(largest < SIGMAS && rms < 1.5, "{largest} {rms}");
}

#[test]
fn a_ball_in_a_lamp_and_a_sky_is_that_of_mitsuba() {
    let lamp = lamp_direction([0.6, 0.5]);
    for (lamp_share, sky) in [(1.0, 0.0), (0.0, 1.0), (0.75, 0.25)] {
        let light = Light {
            lamp: lamp_share,
            sky,
        };
        compare(lamp, light);
    }
}
