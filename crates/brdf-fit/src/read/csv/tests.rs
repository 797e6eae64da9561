//! Tests of the reader of tables.

use super::*;
use crate::scan::Side;

fn scan(text: &str) -> Measurements {
    Measurements::from_reader(text.as_bytes()).unwrap()
}

fn error(text: impl AsRef<[u8]>) -> String {
    Measurements::from_reader(text.as_ref())
        .unwrap_err()
        .to_string()
}

const HEADER: &str = "psi_deg,theta_deg,brdf_per_sr\n";

#[test]
fn columns_come_in_any_order() {
    let text = "n,sigma_per_sr,brdf_per_sr,phi_deg,theta_deg,psi_deg,wavelength_um,comment\n\
                1.6,0.01,0.25,90,20,10,0.63,first\n";
    let scan = scan(text);
    let reading = scan.readings()[0];
    assert_eq!(reading.wavelength_um, Some(0.63));
    assert_eq!(reading.psi, 10_f64.to_radians());
    assert_eq!(reading.theta, 20_f64.to_radians());
    assert_eq!(reading.phi, 90_f64.to_radians());
    assert_eq!(reading.brdf, 0.25);
    assert_eq!(reading.sigma, Some(0.01));
    assert_eq!(scan.refractive_index.unwrap().at(Some(0.63)), Some(1.6));
    assert_eq!(scan.ignored_columns, ["comment"]);
}

#[test]
fn separators_and_line_ends_of_all_systems_are_accepted() {
    let expected = scan("psi_deg,theta_deg,brdf_per_sr\n10,-20.5,0.25\n30,0,0.5\n");
    for text in [
        "psi_deg;theta_deg;brdf_per_sr\n10;-20.5;0.25\n30;0;0.5\n",
        "psi_deg;theta_deg;brdf_per_sr\n10;-20,5;0,25\n30;0;0,5\n",
        "psi_deg\ttheta_deg\tbrdf_per_sr\n10\t-20,5\t2,5e-1\n30\t0\t0.5\n",
        "\u{feff}psi_deg,theta_deg,brdf_per_sr\r\n10,-20.5,0.25\r\n30,0,0.5",
        "psi_deg,theta_deg,brdf_per_sr\r10,-20.5,0.25\r30,0,0.5\r",
        "sep=;\nPSI_DEG; Theta_deg ;\"brdf_per_sr\"\n\n10; -20.5 ;\"0,25\"\n;;\n30;0;0.5;;\n",
    ] {
        assert_eq!(scan(text).readings(), expected.readings(), "{text:?}");
    }
}

#[test]
fn metadata_is_kept_anywhere_in_the_file() {
    let text = "# sample: Paint, black\n# plain words\n\"# licence: MIT\",,\n\
                psi_deg,theta_deg,brdf_per_sr\n10,20,0.1\n# Note: late\n11,20,0.1\n";
    let scan = scan(text);
    assert_eq!(scan.metadata.get("sample"), Some("Paint, black"));
    assert_eq!(scan.metadata.get("licence"), Some("MIT"));
    assert_eq!(scan.metadata.get("note"), Some("late"));
    assert_eq!(scan.readings().len(), 2);
}

#[test]
fn quantities_are_converted_once() {
    let rows = "psi_deg,theta_deg,brdf_per_sr,sigma_per_sr\n10,60,0.5,0.1\n";
    let reading = |quantity: &str| scan(&format!("# quantity: {quantity}\n{rows}")).readings()[0];
    assert_eq!(reading("brdf").brdf, 0.5);
    assert!((reading("brdf_cos").brdf - 1.0).abs() < 1e-15);
    assert!((reading("brdf_cos").sigma.unwrap() - 0.2).abs() < 1e-15);
    assert!((reading("reflectance_factor").brdf - 0.5 / std::f64::consts::PI).abs() < 1e-16);
}

#[test]
fn other_conventions_are_converted_once() {
    let read = |text: &str, theta_positive, phi_zero| {
        let convention = Convention {
            theta_positive,
            phi_zero,
        };
        Measurements::from_reader_with(text.as_bytes(), "test", convention)
            .unwrap()
            .readings()[0]
    };
    let in_plane = format!("{HEADER}10,20,0.1\n");
    let mirror_side = read(&in_plane, Side::Forward, Side::Source);
    assert_eq!(mirror_side.in_plane_theta(), Some(-20_f64.to_radians()));
    let text = "psi_deg,theta_deg,phi_deg,brdf_per_sr\n10,20,0,0.1\n";
    let mirror_side = read(text, Side::Source, Side::Forward);
    assert_eq!(mirror_side.in_plane_theta(), Some(-20_f64.to_radians()));
}

#[test]
fn the_refractive_index_of_the_header_is_read() {
    let text = format!("# refractive_index: 0.63=1.6,0.85=1.58\n{HEADER}10,20,0.1\n");
    assert_eq!(
        scan(&text).refractive_index.unwrap().at(Some(0.85)),
        Some(1.58)
    );
}

#[test]
fn errors_name_line_column_value_and_what_was_expected() {
    let row = |row: &str| error(format!("# sample: x\n{HEADER}10,20,0.1\n{row}\n"));
    assert_eq!(
        row("abc,0,0.1"),
        "input, line 4, column psi_deg: \"abc\" is not a number: expected the incidence angle in degrees"
    );
    assert!(row("1e10,0,0.1").contains("column psi_deg: \"1e10\" is out of range"));
    assert!(row("0,0,-inf").contains("\"-inf\" is not a finite number"));
    assert!(row("0").contains("column theta_deg: \"\" is missing"));
    assert!(row("0,0,0.1,7").contains("line 4: 4 fields: expected 3"));
    assert!(row("0;0;0,1").contains("column psi_deg"));
    assert!(row("0,0,-999").contains("# missing: -999"));
}

#[test]
fn errors_in_optional_columns_name_the_column() {
    let with = |column: &str, value: &str| {
        error(format!(
            "psi_deg,theta_deg,brdf_per_sr,{column}\n10,20,0.1,{value}\n"
        ))
    };
    assert!(with("wavelength_um", "-0.6").contains("column wavelength_um: \"-0.6\""));
    assert!(with("sigma_per_sr", "0").contains("column sigma_per_sr: \"0\""));
    assert!(with("phi_deg", "x").contains("column phi_deg: \"x\""));
    assert!(with("n", "0.9").contains("column n: \"0.9\" is out of range"));
    let two = error("n,psi_deg,theta_deg,brdf_per_sr\n1.5,1,2,3\n1.6,1,2,3\n");
    assert!(
        two.contains("line 3, column n: \"1.6\" differs from 1.5"),
        "{two}"
    );
}

#[test]
fn a_text_that_is_not_a_table_is_refused() {
    assert!(error("").contains("is empty"));
    assert!(error(" \n\n").contains("is empty"));
    assert!(error("# only: comments\n").contains("no header"));
    assert!(error(HEADER).contains("line 1: no readings follow the header"));
    let no_reading = error("psi_deg,theta_deg,x\n1,2,3\n");
    assert!(
        no_reading.contains("no column for the reading (brdf_per_sr)")
            && no_reading.contains("\"psi_deg\" is incidence angle in deg, ")
            && no_reading.contains("\"x\" is not known"),
        "{no_reading}"
    );
    assert!(error("a;b\n1;2\n").contains("has no header"));
    assert!(error("psi_deg,psi_deg,theta_deg,brdf_per_sr\n").contains("in deg is given twice"));
    assert!(error([0x7f, b'E', b'L', b'F', 0, 1]).contains("is binary data"));
    assert!(error(b"\xff\xfep\0").contains("UTF-16"));
    assert!(
        error(format!("# quantity: btdf\n{HEADER}1,2,3\n")).contains("line 1: quantity: \"btdf\"")
    );
    assert!(error(format!("# refractive_index: 0.5\n{HEADER}1,2,3\n")).contains("n = 0.5"));
}

#[test]
fn an_endless_line_is_refused_before_it_fills_the_memory() {
    let endless = std::io::repeat(b'7');
    let message = Measurements::from_reader(endless).unwrap_err().to_string();
    assert!(
        message.contains("line 1: the line is longer than 65536 bytes"),
        "{message}"
    );
    let later = format!("{HEADER}1,2,{}\n", "3".repeat(100_000));
    assert!(error(later).contains("line 2: the line is longer"));
}

#[test]
fn a_stray_quote_is_an_error_of_its_line_in_any_column() {
    let message = error(format!("{HEADER}1,2,\"3\n4,5,6\n"));
    assert!(
        message.contains("line 2: a quote is not closed"),
        "{message}"
    );
    let text = "psi_deg,theta_deg,brdf_per_sr,note\n1,2,3,a\n1,2,3,\"5 inch\n1,2,3,x\"\n";
    assert!(error(text).contains("line 3: a quote is not closed"));
}

#[test]
fn comments_between_rows_hide_no_row_with_any_line_end() {
    for end in ["\n", "\r", "\r\n"] {
        let text = [
            "# a: b",
            "psi_deg,theta_deg,brdf_per_sr",
            "1,2,3",
            "# c",
            "",
            "4,5,6",
            "7,8,9",
        ];
        assert_eq!(scan(&text.join(end)).readings().len(), 3, "{end:?}");
        let bad = [text.as_slice(), &["x,8,9"]].concat().join(end);
        assert!(error(bad).contains("line 8, column psi_deg"), "{end:?}");
    }
}

#[test]
fn a_header_behind_a_comment_sign_is_a_header() {
    let scan = scan("# psi_deg,theta_deg,brdf_per_sr\n1,2,3\n4,5,6\n");
    assert_eq!(scan.readings().len(), 2);
}

#[test]
fn the_separator_is_the_one_that_separates_known_columns() {
    let scan = scan("psi_deg;theta_deg;brdf_per_sr;\"note, a, b, c, d\"\n1;2;3;x\n");
    assert_eq!(scan.ignored_columns, ["note, a, b, c, d"]);
}

#[test]
fn contradictions_between_comments_are_errors() {
    let with = |comments: &str| error(format!("{comments}\n{HEADER}1,2,3\n"));
    let twice = with("# quantity: brdf_cos\n# quantity: brdf");
    assert!(twice.contains("line 2: quantity is given twice"), "{twice}");
    assert!(with("# quantity = btdf").contains("quantity: \"btdf\" is not known"));
    let text = format!("# quantity = brdf_cos\n{HEADER}1,60,0.5\n");
    assert!((scan(&text).readings()[0].brdf - 1.0).abs() < 1e-15);
}

/// The reading of psi = 10, theta = -20 deg and f_r = 0.25 in one row, and another in a second one.
fn first(text: &str) -> Measurement {
    scan(text).readings()[0]
}

#[test]
fn other_names_units_and_quantities_give_the_same_reading() {
    let expected = first("psi_deg,theta_deg,brdf_per_sr\n10,-20,0.25\n30,0,0.5\n");
    for text in [
        "Incident angle,Measure_angle,BRDF (1/sr)\n10,-20,0.25\n30,0,0.5\n",
        "AOI (deg)\ttheta_r\tf_r\n10\t-20\t0.25\n30\t0\t0.5\n",
        "theta_i theta_s  brdf\n10  -20  2.5D-01\n30 0 0.5\n",
        "Printed by Lab 3\n\npsi_deg,theta_deg,brdf_per_sr\n10,\u{2212}20,0.25\n30,0,0.5\n",
        "psi_deg,theta_deg,brdf_per_sr\n\"10\",\"-20\",\"0,25\"\n30,0,0.5\n",
        "psi_rad,theta_rad,brdf\n0.17453292519943295,-0.3490658503988659,0.25\n1,0,0.5\n",
        "psi_deg,theta_deg,R%\n10,-20,78.53981633974483\n30,0,1\n",
        "psi_deg,theta_deg,log10_brdf\n10,-20,-0.6020599913279624\n30,0,1\n",
        "# unit: dB\npsi_deg,theta_deg,brdf\n10,-20,-6.020599913279624\n30,0,1\n",
        "# factor: 0.1\npsi_deg,theta_deg,brdf\n10,-20,2.5\n30,0,1\n",
        "# psi_deg: 10\ntheta_deg,brdf_per_sr\n-20,0.25\n0,0.5\n",
        "psi_deg,theta_deg,brdf_s,brdf_p\n10,-20,0.2,0.3\n30,0,1,1\n",
        "psi_deg,theta_deg,signal,reference\n10,-20,7.853981633974483,10\n30,0,1,1\n",
        "psi_deg,theta_deg,brdf_per_sr\n-10,20,0.25\n30,0,0.5\n",
        "phi_i,theta_i,phi_r,theta_r,brdf\n90,10,270,20,0.25\n0,30,0,0,0.5\n",
        "mu_in,mu_out,cosdphi,brdf\n0.984807753012208,0.9396926207859084,-1,0.25\n0.5,1,1,0.5\n",
    ] {
        let found = first(text);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(
            near(found.psi, expected.psi)
                && near(found.in_plane_theta().unwrap(), expected.theta)
                && near(found.brdf, 0.25),
            "{text}: {found:?}"
        );
    }
}

#[test]
fn wavelengths_are_read_from_columns_names_and_comments() {
    for (text, expected) in [
        (
            "psi_deg,theta_deg,450nm,0.65 um\n1,2,3,4\n",
            vec![Some(0.45), Some(0.65)],
        ),
        (
            "wavelength_nm,psi_deg,theta_deg,brdf\n630.79,1,2,3\n",
            vec![Some(0.63079)],
        ),
        (
            "Wavelength,psi_deg,theta_deg,brdf\n450,1,2,3\n",
            vec![Some(0.45)],
        ),
        (
            "lambda,psi_deg,theta_deg,brdf\n10.6,1,2,3\n",
            vec![Some(10.6)],
        ),
        (
            "# wavelength_nm: 532\npsi_deg,theta_deg,brdf\n1,2,3\n",
            vec![Some(0.532)],
        ),
    ] {
        assert_eq!(scan(text).wavelengths(), expected, "{text}");
    }
    let both = error("wavelength,psi_deg,theta_deg,brdf\n0.5,1,2,3\n500,1,2,3\n");
    assert!(
        both.contains("the unit of \"wavelength\" is not known"),
        "{both}"
    );
}

#[test]
fn what_is_ambiguous_is_an_error() {
    let radians = error("theta_i,theta_r,brdf\n0.5,0.2,3\n");
    assert!(
        radians.contains("\"theta_i_rad\" or \"theta_i_deg\""),
        "{radians}"
    );
    let exchanged = error("phi_i,theta_i,phi_o,theta_o,brdf\n75,-180,-80,0,1\n");
    assert!(exchanged.contains("azimuths exchanged?"), "{exchanged}");
    let percent = error("# unit: percent\npsi_deg,theta_deg,brdf\n1,2,3\n");
    assert!(
        percent.contains("quantity: reflectance_factor"),
        "{percent}"
    );
    let twice = error("# quantity: brdf_cos\npsi_deg,theta_deg,R%\n1,2,3\n");
    assert!(twice.contains("the values are f_r cos theta"), "{twice}");
    let several = error("psi_deg,theta_deg,brdf,450nm\n1,2,3,4\n");
    assert!(several.contains("in several ways"), "{several}");
}

#[test]
fn readings_of_different_samples_are_not_pooled() {
    let table = "psi_deg,theta_deg,brdf,paint\n1,2,3,red\n1,3,3,blue\n1,2,4,blue\n";
    let message = error(table);
    assert!(
        message.contains("\"paint\" differs") && message.contains("lines 2 and 4"),
        "{message}"
    );
    assert_eq!(scan(&table.replace("paint", "repeat")).readings().len(), 3);
    let label = ReadOptions {
        columns: vec![("Paint".to_owned(), "ignore".to_owned())],
        ..ReadOptions::default()
    };
    let scan = Measurements::from_bytes("a.csv", table.as_bytes(), &label).unwrap();
    assert_eq!(scan.readings().len(), 3);
    assert_eq!(scan.ignored_columns, ["paint"]);
}

#[test]
fn options_say_what_columns_are_and_what_comments_lack() {
    let table = "# quantity: brdf\na,b,c\n10,60,50\n";
    let named = |pairs: &[(&str, &str)]| {
        pairs
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
            .collect()
    };
    let options = ReadOptions {
        columns: named(&[("a", "psi_deg"), ("b", "theta_deg"), ("c", "brdf")]),
        declarations: named(&[("quantity", "brdf_cos"), ("factor", "0.01")]),
        ..ReadOptions::default()
    };
    let scan = Measurements::from_bytes("a.csv", table.as_bytes(), &options).unwrap();
    assert!((scan.readings()[0].brdf - 1.0).abs() < 1e-14);
    for (columns, expected) in [
        (&[("d", "psi_deg")][..], "no column \"d\""),
        (&[("a", "angle")], "the role \"angle\""),
    ] {
        let options = ReadOptions {
            columns: [named(columns), options.columns.clone()].concat(),
            ..options.clone()
        };
        let read = Measurements::from_bytes("a.csv", table.as_bytes(), &options);
        let message = read.unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn readings_that_were_not_taken_or_are_below_the_horizon_are_counted() {
    let scan = scan(
        "# missing: -1\npsi_deg,theta_deg,brdf\n10,-90,0\n10,-80,NaN\n10,0,\n10,1,-1\n10,2,3\n",
    );
    assert_eq!(scan.readings().len(), 1);
    assert_eq!(
        scan.conversions[1..],
        [
            "3 readings not taken (no value) are left out",
            "1 reading at or beyond 90 deg from the normal is left out"
        ]
    );
}

#[test]
fn a_table_that_is_cut_off_within_a_line_is_an_error() {
    let cut = error(format!("{HEADER}10,-10,0.5\n10,0"));
    let expected = "line 3: the last line has 2 fields and no line end: expected 3";
    assert!(cut.contains(expected), "{cut}");
    for whole in [
        "10,-10,0.5\n10,0\n",
        "10,-10,0.5\n10,0,",
        "10,0\n10,-10,0.5",
    ] {
        assert_eq!(scan(&format!("{HEADER}{whole}")).readings().len(), 1);
    }
}

#[test]
fn a_missing_standard_deviation_is_none() {
    let scan = scan("psi_deg,theta_deg,brdf_per_sr,sigma_per_sr\n1,2,3,0.1\n1,2,3,\n1,2,3\n\u{1a}");
    let sigmas: Vec<_> = scan.readings().iter().map(|r| r.sigma).collect();
    assert_eq!(sigmas, [Some(0.1), None, None]);
}

#[test]
fn conversions_do_not_leave_the_domain() {
    for text in [
        "# factor: 1e300\npsi_deg,theta_deg,brdf\n1,2,1e200\n",
        "psi_deg,theta_deg,log10_brdf\n1,2,400\n",
        "psi_deg,theta_deg,signal,reference\n1,2,1e200,1e-200\n",
        "psi_deg,theta_deg,log10_brdf,sigma\n1,2,-280,1e-20\n",
        "# unit: dB\npsi,10,20,30\n0,1,1e9,2\n",
    ] {
        assert!(error_of_any(text).contains("f_r would be"), "{text}");
    }
    let short = error("wavelength_nm,psi_deg,theta_deg,brdf\n1e-322,1,2,3\n");
    assert!(short.contains("too small for a wavelength"), "{short}");
    for table in ["psi_deg,theta_deg,brdf\n1,2,3\n", "psi,10,20\n0,1,2\n"] {
        let short = error_of_any(&format!("# wavelength_nm: 1e-322\n{table}"));
        assert!(short.contains("wavelength_nm: \"1e-322\""), "{short}");
    }
}

/// The error of a text of any format.
fn error_of_any(text: &str) -> String {
    let read = Measurements::from_bytes("a", text.as_bytes(), &ReadOptions::default());
    read.unwrap_err().to_string()
}

proptest::proptest! {
    #[test]
    fn any_table_is_an_error_or_readings_in_the_domain(
        names in proptest::sample::subsequence(
            vec![
                "psi_rad", "theta_i", "mu_out", "theta_r (deg)", "phi_i", "dphi", "brdf", "R%", "log10_brdf",
                "BRDF (dB)", "450nm", "650 nm", "brdf_s", "brdf_p", "signal", "reference", "wavelength",
                "wavelength_nm", "sigma", "n", "paint",
            ],
            2..7,
        ),
        rows in proptest::collection::vec(proptest::collection::vec("[0-9.,eE+−-]{0,6}", 7), 1..4),
        comment in "(# (factor|unit|quantity|missing|psi_deg): ?[0-9a-z_.e-]{1,6}\n)?",
    ) {
        let row = |row: &Vec<String>| row[..names.len()].join(";");
        let rows: Vec<String> = rows.iter().map(row).collect();
        let table = format!("{comment}{}\n{}\n", names.join(";"), rows.join("\n"));
        if let Ok(scan) = Measurements::from_bytes("a", table.as_bytes(), &ReadOptions::default()) {
            for reading in scan.readings() {
                proptest::prop_assert!(reading.validated().is_ok() && reading.geometry().is_ok());
            }
        }
    }
}
