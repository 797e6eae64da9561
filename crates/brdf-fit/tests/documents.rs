//! What a report writes is read again and is the same, and is readable by people, whatever the readings
//! and the settings are.

use brdf_core::{AnyBrdf, Geometry, ModelParameters, Parameters};
#[cfg(feature = "export")]
use brdf_fit::export::Material;
use brdf_fit::report::{Document, summary, write_curves, write_models, write_parameters};
use brdf_fit::{
    AssumedErrors, Depth, DocumentError, FitOptions, FixedParameters, K1_RANGE, LazyScan, Loss,
    Measurement, Measurements, Model, Parameter, RefractiveIndex, Report, Weights,
};
use proptest::prelude::*;
use proptest::sample::{select, subsequence};
use proptest::test_runner::RngSeed;

/// The longest number that is printed: a double with all of its digits, its sign and its exponent.
const LONGEST_NUMBER: usize = 40;

/// What the readings are.
#[derive(Debug, Clone)]
enum Values {
    /// Those of a model, with relative errors that alternate.
    OfModel { at: [f64; 3], ripple: f64 },
    /// All the same.
    Equal(f64),
    /// Anything.
    Any(Vec<f64>),
}

/// Values far beyond those of any surface.
fn extreme() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 1e-3..10.0,
        1 => -1.0..0.0,
        1 => (-12_f64..12.0).prop_map(|exponent| 10_f64.powf(exponent)),
        2 => select(vec![
            0.0, -0.0, 1.0, 1e-12, -1e-12, 1e-6, 1e6, -1e6, 1e12,
        ]),
    ]
}

fn values() -> impl Strategy<Value = Values> {
    let of_model = (
        -6_f64..2.0,
        -6_f64..0.0,
        -4_f64..1.5,
        select(vec![0.0, 1e-12, 0.03, 0.5, 2.0]),
    );
    prop_oneof![
        5 => of_model.prop_map(|(k2, kd, k1, ripple)| Values::OfModel {
            at: [k2, kd, k1].map(|exponent| 10_f64.powf(exponent)),
            ripple,
        }),
        1 => extreme().prop_map(Values::Equal),
        3 => prop::collection::vec(extreme(), 1..12).prop_map(Values::Any),
    ]
}

/// The angles of a scan in degrees: few or many views at one incidence or several.
fn angles() -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let incidences = subsequence(vec![0.0, 10.0, 30.0, 50.0, 70.0, 89.0, 90.0], 1..=4);
    let views = prop_oneof![
        3 => subsequence((-8..=8).map(|i| 10.0 * f64::from(i)).collect::<Vec<_>>(), 4..=12),
        1 => subsequence(vec![-90.0, -30.0, -10.0, 0.0, 10.0, 30.0, 89.9], 1..=4),
    ];
    let azimuth = prop_oneof![4 => Just(0.0), 1 => Just(90.0), 1 => 0.0..360.0];
    (incidences, views, azimuth).prop_map(|(incidences, views, phi)| {
        let of = |psi: f64| views.iter().map(move |theta| (psi, *theta, phi));
        incidences.iter().flat_map(|psi| of(*psi)).collect()
    })
}

fn scans() -> impl Strategy<Value = Measurements> {
    let sigma = prop_oneof![3 => Just(None), 1 => select(vec![1e-9, 1e-3, 1e9]).prop_map(Some)];
    let wavelength = prop_oneof![Just(None), Just(Some(0.63))];
    (angles(), values(), sigma, wavelength).prop_map(|(angles, values, sigma, wavelength_um)| {
        let reading = |(i, &(psi, theta, phi)): (usize, &(f64, f64, f64))| {
            let [psi, theta, phi] = [psi, theta, phi].map(f64::to_radians);
            Measurement {
                wavelength_um,
                psi,
                theta,
                phi,
                brdf: values.at(i, psi, theta, phi),
                sigma,
            }
        };
        let readings = angles.iter().enumerate().map(reading).collect();
        Measurements::new("scan", readings).unwrap()
    })
}

impl Values {
    fn at(&self, i: usize, psi: f64, theta: f64, phi: f64) -> f64 {
        match self {
            Self::OfModel {
                at: [k2, kd, k1],
                ripple,
            } => {
                let at = Parameters::new(*k2, *kd, *k1).unwrap();
                let brdf = AnyBrdf::new(Model::Three.family(), &ModelParameters::three(at, 1.5));
                let value = brdf
                    .unwrap()
                    .value(&Geometry::new(psi, theta, phi).unwrap());
                let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
                let value = value * (1.0 + sign * ripple);
                if value.is_finite() { value } else { 0.0 }
            }
            Self::Equal(value) => *value,
            Self::Any(all) => all[i % all.len()],
        }
    }
}

fn fixed() -> impl Strategy<Value = FixedParameters> {
    let (lowest, highest) = K1_RANGE;
    prop_oneof![
        4 => Just(FixedParameters::none()),
        1 => select(vec![lowest, highest])
            .prop_map(|k1| FixedParameters::none().with(Parameter::K1, k1)),
    ]
}

fn options() -> impl Strategy<Value = FitOptions> {
    let errors = select(vec![
        AssumedErrors::Constant,
        AssumedErrors::Stated,
        AssumedErrors::Relative,
    ]);
    let robust =
        prop_oneof![3 => Just(None), 1 => select(vec![Loss::Huber, Loss::Tukey]).prop_map(Some)];
    let index = select(vec![1.0, 1.000_001, 1.5, 1e5]);
    let energy_limit = prop_oneof![4 => Just(None), 1 => Just(Some(80_f64.to_radians()))];
    (
        select(Model::ALL.to_vec()),
        index,
        (errors, any::<bool>()),
        robust,
        energy_limit,
        fixed(),
        0_u8..4,
    )
        .prop_map(
            |(model, n, (errors, by_solid_angle), robust, energy_limit, fixed, stages)| {
                let all = FitOptions::default();
                FitOptions {
                    model,
                    refractive_index: Some(RefractiveIndex::Same(n)),
                    weights: Weights {
                        errors,
                        by_solid_angle: by_solid_angle && errors == AssumedErrors::Constant,
                        ..Weights::default()
                    },
                    robust,
                    energy_limit,
                    fixed: fixed.within(model),
                    stage1: all.stage1.filter(|_| stages != 1),
                    stage2: all.stage2.filter(|_| stages != 2),
                    ..all
                }
            },
        )
}

fn check(scan: &Measurements, options: &FitOptions, depth: Depth) -> Result<(), TestCaseError> {
    let (report, _) = Report::new(scan, options, depth);
    check_text(scan, &report)?;
    let has_fit = report.fit.is_some();
    let document = Document::new(vec![report]);
    let json = serde_json::to_string(&document).unwrap();
    let read: Document = serde_json::from_str(&json)
        .map_err(|error| TestCaseError::fail(format!("{error} in {json}")))?;
    prop_assert_eq!(&serde_json::to_string(&read).unwrap(), &json);
    // A document equals itself only if it contains no undefined number.
    prop_assert_eq!(&read.reports, &document.reports);
    match Document::from_bytes("fit.json", json.as_bytes()) {
        Ok(read) => {
            let wavelength_um = scan.wavelengths()[0];
            prop_assert_eq!(
                read.by_file().options_for("scan", wavelength_um),
                Some(options)
            );
        }
        Err(DocumentError::NoFits { .. }) => prop_assert!(!has_fit),
        Err(error) => prop_assert!(false, "{error}"),
    }
    #[cfg(feature = "export")]
    if has_fit {
        let material = Material::from_bytes("fit.json", json.as_bytes());
        prop_assert!(material.is_ok(), "{:?}: {json}", material.err());
    }
    Ok(())
}

/// Checks that no number in the texts is longer than a double with all of its digits, and that what is
/// not determined is said.
fn check_text(scan: &Measurements, report: &Report) -> Result<(), TestCaseError> {
    let reports = std::slice::from_ref(report);
    let mut tables = Vec::new();
    write_parameters(reports, &mut tables).unwrap();
    write_models(reports, &mut tables).unwrap();
    let scan = LazyScan::Loaded(scan.clone());
    let fits = report.fit.iter().map(|fit| (&scan, fit));
    write_curves(fits, &mut tables).unwrap();
    let tables = String::from_utf8(tables).unwrap();
    let texts = [
        report.text(),
        report.detailed_text(),
        summary(reports).text(),
        tables.replace(',', " "),
    ];
    for text in &texts {
        for word in text.split_whitespace() {
            let is_number = word
                .bytes()
                .all(|byte| b"0123456789.+-e%()".contains(&byte));
            let is_long = word.len() > LONGEST_NUMBER;
            prop_assert!(!(is_number && is_long), "{word} in\n{text}");
            prop_assert!(!word.contains("NaN"), "{text}");
            // An error may say that the weighted readings are too large for any number.
            let may_overflow = report.error.is_some();
            prop_assert!(may_overflow || !["inf", "-inf"].contains(&word), "{text}");
        }
    }
    let estimates = report.uncertainty.iter().flat_map(|u| &u.estimates);
    for estimate in estimates.filter(|estimate| !estimate.is_determined()) {
        let said = format!("not determine {}", estimate.parameter);
        prop_assert!(
            brdf_text(&texts[0]).contains(&said),
            "{said}:\n{}",
            texts[0]
        );
    }
    Ok(())
}

/// A text without its line breaks.
fn brdf_text(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

proptest! {
    // One sequence of scans, so that a failure is the same on every machine.
    #![proptest_config(ProptestConfig {
        cases: 200,
        rng_seed: RngSeed::Fixed(15),
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_report_is_read_as_it_was_written(
        scan in scans(),
        options in options(),
        depth in select(vec![Depth::Fit, Depth::Tested, Depth::Assessed]),
    ) {
        check(&scan, &options, depth)?;
    }
}

/// The first readings of a measured sample, which once gave intervals without end.
#[test]
fn readings_that_determine_little_are_read_as_they_were_written() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../data/measured/z307_on_aluminium_cycled.csv"
    );
    let scan = Measurements::read_csv(path).unwrap();
    let first = scan.readings()[..55].to_vec();
    let scan = Measurements::new("scan", first).unwrap();
    for model in Model::ALL {
        let options = FitOptions {
            model,
            refractive_index: Some(RefractiveIndex::Same(1.5)),
            ..FitOptions::default()
        };
        check(&scan, &options, Depth::Assessed).unwrap();
    }
}
