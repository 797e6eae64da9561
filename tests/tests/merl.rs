//! MERL tables through the built programs, and exported ones as others read them: by the directions of
//! the real Mitsuba, and looked up as the reference code of the database does. Skipped where there is
//! no Python with mitsuba or NumPy, or no LLVM for Mitsuba.

use std::f64::consts::TAU;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::OnceLock;

use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
use brdf_fit::export::{Fitted, Material};
use brdf_fit::read::merl::{Bins, Channel};
use brdf_tests::{export_command, generator, run_fit, run_python, trade_command};
use rand::RngExt as _;
use serde_json::{Value, json};

const BAD: i32 = 2;

/// Wavelength in micrometres and k2, kD, k1 of blue, green and red, in the order in which they are
/// read; n = 1.5.
const COLOURED: [(f64, [f64; 3]); 3] = [
    (0.46, [0.1, 0.05, 0.15]),
    (0.55, [0.3, 0.1, 0.3]),
    (0.62, [0.225, 0.246, 0.9]),
];

const GREY: (f64, [f64; 3]) = (1.04, [0.4, 0.02, 0.08]);

fn brdf([k2, kd, k1]: [f64; 3]) -> AnyBrdf {
    let at = ModelParameters {
        k2,
        kd,
        k1,
        n: 1.5,
        p: 1.0,
    };
    AnyBrdf::new(Family::Paper, &at).unwrap()
}

/// The BRDFs of red, green and blue.
fn channels() -> [AnyBrdf; 3] {
    [2, 1, 0].map(|i| brdf(COLOURED[i].1))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn succeeded(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// Writes the model of a coating as JSON, beside the file that will be made of it.
fn model(path: &Path, fits: &[(f64, [f64; 3])]) -> PathBuf {
    let fits = fits.iter().map(|&(um, at)| Fitted {
        file: "made-up.csv".to_owned(),
        wavelength_um: Some(um),
        brdf: brdf(at),
        e_percent: 1.0,
        psi_max_deg: 70.0,
    });
    let mut bytes = Vec::new();
    let coating = Material {
        fits: fits.collect(),
    };
    coating.write(&mut bytes).unwrap();
    let model = path.with_extension("json");
    fs::write(&model, bytes).unwrap();
    model
}

/// A table of 35 MB, and what was said when it was exported.
struct Exported {
    path: PathBuf,
    said: String,
}

impl Exported {
    fn new(name: &str, fits: &[(f64, [f64; 3])]) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let mut command = export_command();
        command.arg(model(&path, fits)).args(["--to", "merl", "-o"]);
        let said = succeeded(&command.arg(&path).output().unwrap());
        Self { path, said }
    }

    /// The median and the worst error of the nearest bin in red, green and blue, as it was said.
    fn errors(&self) -> [[f64; 2]; 3] {
        let (_, said) = self.said.split_once("f_r ").unwrap();
        let numbers = said.split(" %").filter_map(|part| {
            let percent: f64 = part.rsplit(' ').next()?.parse().ok()?;
            Some(percent / 100.0)
        });
        let numbers: Vec<f64> = numbers.collect();
        let (pairs, rest) = numbers.as_chunks::<2>();
        assert!(rest.is_empty(), "{}", self.said);
        pairs.try_into().unwrap()
    }
}

fn coloured() -> &'static Exported {
    static TABLE: OnceLock<Exported> = OnceLock::new();
    TABLE.get_or_init(|| Exported::new("coloured.binary", &COLOURED))
}

fn grey() -> &'static Exported {
    static TABLE: OnceLock<Exported> = OnceLock::new();
    TABLE.get_or_init(|| Exported::new("grey.binary", &[GREY]))
}

fn fit(path: &Path, options: &[&str]) -> Output {
    let options = options.iter().map(OsStr::new);
    run_fit(
        [path.as_os_str(), "--n".as_ref(), "1.5".as_ref()]
            .into_iter()
            .chain(options),
    )
}

/// Wavelength, k2, kD and k1 of each line that --params-only prints.
fn parameters(printed: &str) -> Vec<[f64; 4]> {
    let mut lines = csv::Reader::from_reader(printed.as_bytes());
    let lines = lines.records().map(|line| {
        let line = line.unwrap();
        [1, 3, 4, 5].map(|column| line[column].parse().unwrap())
    });
    lines.collect()
}

fn assert_parameters(printed: &str, expected: [[f64; 3]; 3], tolerance: f64) {
    let found = parameters(printed);
    assert_eq!(found.len(), 3, "{printed}");
    let wavelengths = [0.464, 0.549, 0.611];
    for (([um, k2, kd, k1], wavelength), expected) in
        found.into_iter().zip(wavelengths).zip(expected)
    {
        assert_eq!(um, wavelength);
        for (found, expected) in [k2, kd, k1].into_iter().zip(expected) {
            assert!((found - expected).abs() < tolerance, "{printed}");
        }
    }
}

#[test]
fn the_parameters_of_three_wavelengths_come_back() {
    let path = &coloured().path;
    let expected = COLOURED.map(|(_, at)| at);
    for (sample, tolerance) in [([].as_slice(), 1e-9), (&["--sample", "5000"], 1e-6)] {
        let options = [["--params-only"].as_slice(), sample].concat();
        assert_parameters(&succeeded(&fit(path, &options)), expected, tolerance);
    }
}

#[test]
fn one_fit_is_exported_as_grey() {
    let printed = succeeded(&fit(&grey().path, &["--params-only"]));
    assert_parameters(&printed, [GREY.1; 3], 1e-9);
    let said = &grey().said;
    assert!(
        said.contains("grey.binary; nearest bin up to 85 deg: f_r within "),
        "{said}"
    );
    assert!(!said.contains("green"), "{said}");
}

#[test]
fn the_report_says_how_a_table_is_read() {
    let printed = succeeded(&fit(&coloured().path, &["--sample", "500"]));
    for said in [
        "read MERL table, red assigned to 0.611 um: f_r at the centre of each bin of theta_h, theta_d, phi_d",
        "MERL table, blue assigned to 0.464 um",
        "read 500 of 1096216 readings, evenly over theta_h, theta_d and phi_d",
    ] {
        let printed = brdf_tests::unwrapped(&printed);
        assert!(printed.contains(said), "{printed}");
    }
}

#[test]
fn pictures_and_curves_are_made_of_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let (pictures, curves) = (
        folder.path().join("pictures"),
        folder.path().join("curves.csv"),
    );
    let options = [
        "--sample",
        "300",
        "--curves",
        curves.to_str().unwrap(),
        "--plot",
    ];
    let options = [options.as_slice(), &[pictures.to_str().unwrap()]].concat();
    succeeded(&fit(&coloured().path, &options));
    // A header, and 300 readings of each channel.
    let lines = fs::read_to_string(curves).unwrap();
    assert_eq!(lines.lines().count(), 901);
    assert!(pictures.join("report.html").is_file());
    for um in ["0.464", "0.549", "0.611"] {
        let name = format!("coloured-{um}um-theory-linear");
        let svg = fs::read_to_string(pictures.join(format!("{name}.svg"))).unwrap();
        assert!(svg.starts_with("<svg"), "{um}");
        let png = fs::read(pictures.join(format!("{name}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG"), "{um}");
    }
}

const SMALL: Bins = Bins {
    theta_h: 6,
    theta_d: 5,
    phi_d: 8,
};

fn header(bins: [i32; 3]) -> Vec<u8> {
    bins.map(i32::to_le_bytes).concat()
}

/// A table of few bins.
fn small() -> Vec<u8> {
    let mut bytes = header([6, 5, 8]);
    for (channel, brdf) in Channel::ALL.into_iter().zip(channels()) {
        for bin in 0..SMALL.count() {
            let middle = SMALL.centre([bin / 40, bin / 8 % 5, bin % 8]);
            let value = middle.map_or(-1.0, |at| value(&brdf, at) / channel.scale());
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

fn value(brdf: &AnyBrdf, [psi, theta, phi]: [f64; 3]) -> f64 {
    brdf.value(&Geometry::new(psi, theta, phi).unwrap())
}

#[test]
fn a_table_of_other_bins_is_fitted_and_its_fits_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.binary");
    fs::write(&path, small()).unwrap();
    let expected = COLOURED.map(|(_, at)| at);
    assert_parameters(&succeeded(&fit(&path, &["--params-only"])), expected, 1e-9);
    let mut command = trade_command();
    let output = command.arg("fit").arg(&path).args(["--n", "1.5"]).output();
    let printed = succeeded(&output.unwrap());
    assert!(
        printed.contains("0.464 um") && printed.contains("0.611 um"),
        "{printed}"
    );
}

#[test]
fn a_table_is_known_by_its_content_and_can_be_forced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.txt");
    fs::write(&path, small()).unwrap();
    let expected = COLOURED.map(|(_, at)| at);
    assert_parameters(&succeeded(&fit(&path, &["--params-only"])), expected, 1e-9);
    fs::write(&path, &small()[..500]).unwrap();
    let message = "is truncated: 6 x 5 x 8 bins of three channels are 5772 bytes, the file has 500";
    let said = |options: &[&str]| {
        let output = fit(&path, options);
        assert_eq!(output.status.code(), Some(BAD));
        text(&output.stderr)
    };
    assert!(!said(&[]).contains(message));
    assert_eq!(
        said(&["--format", "merl"]),
        format!("error: {}: {message}\n", path.display())
    );
    let content = fs::read_to_string(brdf_tests::in_workspace(
        "data/synthetic/table1_001_0.91um.csv",
    ));
    fs::write(folder.path().join("scan.binary"), content.unwrap()).unwrap();
    let forced = fit(
        &folder.path().join("scan.binary"),
        &["--format", "csv", "--params-only"],
    );
    assert_eq!(parameters(&succeeded(&forced)).len(), 1);
}

#[test]
fn the_sides_of_a_table_are_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.binary");
    fs::write(&path, small()).unwrap();
    for option in ["--theta-positive", "--phi-zero"] {
        let output = fit(&path, &[option, "forward"]);
        assert_eq!(output.status.code(), Some(BAD));
        let expected = format!(
            "error: {}: the angular convention cannot be chosen: a MERL table has angles about the half vector\n",
            path.display()
        );
        assert_eq!(text(&output.stderr), expected);
    }
}

/// Runs `fit` with little memory to take, where the system can be told so.
fn fit_in_little_memory(path: &Path) -> Output {
    let program = brdf_tests::fit_command();
    let program = program.get_program();
    if !cfg!(target_os = "linux") {
        return fit(path, &[]);
    }
    let mut command = std::process::Command::new("sh");
    let limited = "ulimit -v 1000000; exec \"$0\" \"$1\" --n 1.5";
    command
        .args(["-c", limited])
        .arg(program)
        .arg(path)
        .output()
        .unwrap()
}

#[test]
fn damaged_tables_are_told_with_their_numbers_and_nothing_is_taken_for_their_headers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("damaged.binary");
    let refused = |message: &str| {
        let output = fit_in_little_memory(&path);
        let expected = format!("error: {}: {message}\n", path.display());
        assert_eq!(text(&output.stderr), expected);
        assert_eq!(output.status.code(), Some(BAD), "{expected}");
    };
    let change = |from: usize, with: &[u8]| {
        let mut bytes = small();
        bytes[from..from + with.len()].copy_from_slice(with);
        bytes
    };
    let big_endian = [6_i32, 5, 8].map(i32::to_be_bytes).concat();
    let short = "has 11 bytes: expected a MERL table, which begins with three numbers of bins in 12 \
                  bytes";
    let size = "bins of three channels are";
    let positive = "expected three positive numbers, such as 90 x 90 x 180 of the MERL database";
    let finite = "is not a finite number: expected f_r, or a negative number for a bin that was not \
                  measured";
    for (bytes, message) in [
        (small()[..11].to_vec(), short.to_owned()),
        (
            small()[..5771].to_vec(),
            format!("is truncated: 6 x 5 x 8 {size} 5772 bytes, the file has 5771"),
        ),
        (
            [small(), vec![0]].concat(),
            format!("is too long: 6 x 5 x 8 {size} 5772 bytes, the file has 5773"),
        ),
        (
            header([90, 90, 180]),
            format!("is truncated: 90 x 90 x 180 {size} 34992012 bytes, the file has 12"),
        ),
        (
            change(0, &header([6, -5, 8])),
            format!("6 x -5 x 8 bins: {positive}"),
        ),
        (
            change(0, &header([6, 5, 0])),
            format!("6 x 5 x 0 bins: {positive}"),
        ),
        (
            change(0, &header([i32::MAX; 3])),
            format!("2147483647 x 2147483647 x 2147483647 bins: {positive}"),
        ),
        (
            change(0, &header([i32::MAX, 90, 180])),
            "2147483647 x 90 x 180 bins: expected at most 16777216 in a channel".to_owned(),
        ),
        (
            change(0, &big_endian),
            "is a MERL table in big-endian order: expected little-endian numbers".to_owned(),
        ),
        (
            change(12 + 8 * (240 + 9), &f64::NAN.to_le_bytes()),
            format!("green, bin (0, 1, 1): NaN {finite}"),
        ),
        (
            change(12, &f64::INFINITY.to_le_bytes()),
            format!("red, bin (0, 0, 0): inf {finite}"),
        ),
    ] {
        fs::write(&path, bytes).unwrap();
        refused(&message);
    }
    // A file without content is as long as its header says.
    fs::write(&path, header([30_000, 30_000, 1])).unwrap();
    let file = fs::File::options().write(true).open(&path).unwrap();
    if file.set_len(12 + 3 * 8 * 900_000_000).is_ok() {
        refused("30000 x 30000 x 1 bins: expected at most 16777216 in a channel");
    }
}

#[test]
fn a_tolerance_is_refused_where_the_bins_do_not_keep_to_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.binary");
    let export = |tolerance: &str| {
        let mut command = export_command();
        command
            .arg(model(&path, &COLOURED))
            .args(["--to", "merl", "--tolerance", tolerance, "-o"]);
        command.arg(&path).output().unwrap()
    };
    let output = export("0.03");
    assert_eq!(output.status.code(), Some(BAD));
    let said = text(&output.stderr);
    assert!(
        said.starts_with(
            "error: the maximum error of a MERL table exceeds the tolerance 3e-2 (nearest bin up to 85 deg"
        ),
        "{said}"
    );
    assert!(
        said.contains("): expected no tolerance, or another format"),
        "{said}"
    );
    assert!(!path.exists());
    let said = succeeded(&export("0.5"));
    assert_eq!(
        said,
        coloured()
            .said
            .replace(coloured().path.to_str().unwrap(), path.to_str().unwrap())
    );
}

fn directions([psi, theta, phi]: [f64; 3]) -> [[f64; 3]; 2] {
    [
        [psi.sin(), 0.0, psi.cos()],
        [
            theta.sin() * phi.cos(),
            theta.sin() * phi.sin(),
            theta.cos(),
        ],
    ]
}

/// What a script finds for direction pairs of a table.
fn found(
    module: &str,
    script: &str,
    bins: Option<&[Vec<usize>; 3]>,
    at: &[[f64; 3]],
) -> Option<Value> {
    let side = |i: usize| at.iter().map(|&at| directions(at)[i]).collect::<Vec<_>>();
    let mut job = json!({ "path": coloured().path, "sources": side(0), "views": side(1) });
    if let Some(bins) = bins {
        job["bins"] = json!(bins);
    }
    run_python(module, script, &job)
}

fn numbers(value: &Value) -> Vec<f64> {
    serde_json::from_value(value.clone()).unwrap()
}

/// Mitsuba turns directions into the coordinates of the table with code of its own, in single
/// precision: near the middle of the lobe, where `theta_h` is 0.003 deg, that costs 1e-4.
#[test]
fn mitsuba_finds_the_values_of_the_core_in_the_bins_of_its_own_coordinates() {
    let every = |step: usize, end: usize| (0..end).step_by(step).collect::<Vec<_>>();
    let bins = [every(6, 90), every(6, 60), every(12, 180)];
    let [h, d, p] = &bins;
    let all = h.iter().flat_map(|&i| {
        d.iter()
            .flat_map(move |&j| p.iter().map(move |&k| [i, j, k]))
    });
    let middles = all.filter_map(|bin| Bins::STANDARD.centre(bin));
    let at: Vec<_> = middles.filter(|at| at[0].max(at[1]) < 1.52).collect();
    assert!(at.len() > 1000);
    let Some(found) = found("mitsuba", "merl_in_mitsuba.py", Some(&bins), &at) else {
        return;
    };
    for (channel, brdf) in found.as_array().unwrap().iter().zip(channels()) {
        for (found, &at) in numbers(channel).into_iter().zip(&at) {
            let error = (found / value(&brdf, at) - 1.0).abs();
            assert!(error < 3e-4, "{at:?}: {error}");
        }
    }
}

#[test]
fn a_lookup_as_in_the_reference_code_finds_f_r_within_the_error_that_was_said() {
    let mut random = generator(5);
    let mut angle = |to: f64| random.random_range(0.0..to);
    let limit = 85.0_f64.to_radians();
    let at: Vec<[f64; 3]> = (0..20_000)
        .map(|_| [angle(limit), angle(limit), angle(TAU)])
        .collect();
    let Some(found) = found("numpy", "merl_lookup.py", None, &at) else {
        return;
    };
    let bins: Vec<[usize; 3]> = serde_json::from_value(found["bins"].clone()).unwrap();
    for (&bin, &at) in bins.iter().zip(&at) {
        assert_eq!(bin, Bins::STANDARD.bin_of(at), "{at:?}");
    }
    for (c, brdf) in channels().iter().enumerate() {
        let values = numbers(&found["channels"][c]);
        for (found, &bin) in values.iter().zip(&bins) {
            let middle = value(brdf, Bins::STANDARD.centre(bin).unwrap());
            assert!((found / middle - 1.0).abs() < 4.0 * f64::EPSILON, "{bin:?}");
        }
        let errors = values
            .iter()
            .zip(&at)
            .map(|(found, &at)| (found / value(brdf, at) - 1.0).abs());
        let mut errors: Vec<f64> = errors.collect();
        errors.sort_by(f64::total_cmp);
        // The worst lie where both directions are at the limit, which few of so many come near.
        let [median, worst] = coloured().errors()[c];
        let (found_median, found_worst) = (errors[10_000], errors[19_999]);
        println!("{c}: median {found_median} of {median}, worst {found_worst} of {worst}");
        assert!(
            (found_median / median - 1.0).abs() < 0.05,
            "{c}: {found_median} {median}"
        );
        assert!(
            found_worst < 1.05 * worst && found_worst > 0.5 * worst,
            "{c}: {found_worst} {worst}"
        );
    }
}
