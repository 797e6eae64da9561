//! The verdict on the models for measured scans, as they are and disturbed: it should not change with
//! the choice of views, nor with noise of 1 %.

use brdf_fit::{FitOptions, Measurement, Measurements, Model, RefractiveIndex, assess, fit};
use brdf_tests::{generator, normal, one_wavelength, shared_data};

const SCANS: [(&str, f64); 13] = [
    ("blacklab/z307_on_aluminium.csv", 0.630_79),
    ("blacklab/z307_on_aluminium.csv", 0.852_23),
    ("blacklab/z307_on_aluminium_cycled.csv", 0.630_79),
    ("blacklab/z307_on_aluminium_cycled.csv", 0.852_23),
    ("blacklab/z307_on_aluminium_cycled.csv", 1.059),
    ("rt300s/z307_on_aluminium.csv", 0.65),
    ("rt300s/z307_on_aluminium_0_60.csv", 0.65),
    ("blacklab/black_anodise_on_aluminium.csv", 0.630_79),
    ("blacklab/black_anodise_on_aluminium.csv", 0.852_23),
    ("blacklab/titanium_anodise.csv", 0.385_65),
    ("blacklab/titanium_anodise.csv", 1.059),
    ("rt300s/magic_black.csv", 0.65),
    ("rt300s/anoblack_ec1_on_aluminium.csv", 0.65),
];

/// Every second reading of each incidence, from the first or the second on.
fn every_second(scan: &Measurements, from: usize) -> Measurements {
    let readings = scan.incidences().into_iter().flat_map(|incidence| {
        // A single reading stays.
        let from = if incidence.readings.len() == 1 {
            0
        } else {
            from
        };
        incidence.readings.into_iter().skip(from).step_by(2)
    });
    let readings = readings.map(|i| scan.readings()[i]).collect();
    Measurements::new("every second", readings).unwrap()
}

/// 1 % of gain of each incidence, and 1 % of each reading.
fn disturbed(scan: &Measurements, seed: u64) -> Measurements {
    let mut generator = generator(seed);
    let mut readings: Vec<Measurement> = scan.readings().to_vec();
    for incidence in scan.incidences() {
        let gain = 1.0 + 0.01 * normal(&mut generator);
        for i in incidence.readings {
            readings[i].brdf *= gain * (1.0 + 0.01 * normal(&mut generator));
        }
    }
    Measurements::new("disturbed", readings).unwrap()
}

fn verdict(scan: &Measurements) -> (Option<Model>, String) {
    let options = FitOptions {
        refractive_index: Some(RefractiveIndex::Same(1.5)),
        ..FitOptions::default()
    };
    let fitted = fit(scan, &options).unwrap();
    let verdict = assess(scan, &fitted, false).unwrap().verdict.unwrap();
    let others: Vec<&str> = verdict.not_told_apart.iter().map(|m| m.name()).collect();
    let name = verdict.model.map_or("none", Model::name);
    (verdict.model, format!("{name} ({})", others.join(", ")))
}

#[test]
fn the_verdict_does_not_change_with_views_and_noise() {
    let Some(folder) = shared_data() else {
        return;
    };
    let (mut same, mut pairs) = (0_u32, 0_u32);
    for (file, um) in SCANS {
        let scan = one_wavelength(&folder.join(file), um);
        let scan = if file.contains("ec1") {
            scan.thinned(scan.readings().len() / 3)
        } else {
            scan
        };
        let versions = [
            scan.clone(),
            every_second(&scan, 0),
            every_second(&scan, 1),
            disturbed(&scan, 1),
            disturbed(&scan, 2),
        ];
        let found = versions.map(|version| verdict(&version));
        let texts: Vec<&str> = found.iter().map(|(_, text)| text.as_str()).collect();
        println!("| {file} {um} | {} |", texts.join(" | "));
        for (i, first) in found.iter().enumerate() {
            for second in &found[i + 1..] {
                pairs += 1;
                same += u32::from(first.0 == second.0);
            }
        }
    }
    let percent = 100.0 * f64::from(same) / f64::from(pairs);
    println!("the same verdict in {percent:.1} % of {pairs} pairs");
    assert!(percent >= 95.0, "{percent} %");
}
