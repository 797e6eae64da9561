//! Tests of whole files.

use proptest::prelude::*;

use super::*;
use crate::scan::Side;

/// A basis of five patches: one around the normal, four around it.
const BASIS: &str = "<AngleBasis><AngleBasisName>Five</AngleBasisName>\
    <AngleBasisBlock><Theta>0</Theta><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta>\
    <UpperTheta>20</UpperTheta></ThetaBounds></AngleBasisBlock>\
    <AngleBasisBlock><Theta>40</Theta><nPhis>4</nPhis><ThetaBounds><LowerTheta>20</LowerTheta>\
    <UpperTheta>60</UpperTheta></ThetaBounds></AngleBasisBlock></AngleBasis>";

fn block(direction: &str, values: &str) -> String {
    format!(
        "<WavelengthDataBlock><WavelengthDataDirection>{direction}</WavelengthDataDirection>\n\
         <ColumnAngleBasis>Five</ColumnAngleBasis><RowAngleBasis>Five</RowAngleBasis>\n\
         <ScatteringDataType>BRDF</ScatteringDataType>\n<ScatteringData>\n{values}\n</ScatteringData>\n\
         </WavelengthDataBlock>\n"
    )
}

fn data(wavelength: &str, blocks: &str) -> String {
    format!("<WavelengthData>{wavelength}\n{blocks}</WavelengthData>\n")
}

fn file(structure: &str, data: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<WindowElement xmlns=\"http://windows.lbl.gov\">\
         <Optical><Layer><Material><Name>Test paint</Name></Material>\n<DataDefinition>\
         <IncidentDataStructure>{structure}</IncidentDataStructure>\n{BASIS}\n</DataDefinition>\n{data}\
         </Layer></Optical></WindowElement>\n"
    )
}

const VISIBLE: &str = "<Wavelength unit=\"Integral\">Visible</Wavelength>";

/// Each value tells its row and column.
fn numbered() -> String {
    let row = |row: u32| (0..5).map(move |column| format!("{row}.{column}"));
    let rows: Vec<String> = (0..5)
        .map(|i| row(i).collect::<Vec<_>>().join(", ") + ",")
        .collect();
    rows.join("\n")
}

fn small() -> String {
    file(
        "Columns",
        &data(VISIBLE, &block("Reflection Front", &numbered())),
    )
}

fn read_with(text: &str, options: &ReadOptions) -> Result<Measurements, ReadError> {
    read(Path::new("a.xml"), text.as_bytes(), options)
}

fn scan(text: &str) -> Measurements {
    read_with(text, &ReadOptions::default()).unwrap()
}

fn error(text: &str) -> String {
    let read = read_with(text, &ReadOptions::default());
    read.unwrap_err().to_string()
}

/// psi, theta, phi and f_r, in degrees and 1/sr.
fn degrees(reading: &Measurement) -> (f64, f64, f64, f64) {
    let phi = reading.phi.to_degrees().rem_euclid(360.0).round();
    let (psi, theta) = (
        reading.psi.to_degrees().round(),
        reading.theta.to_degrees().round(),
    );
    (psi, theta, phi, reading.brdf)
}

#[test]
fn columns_are_incident_patches_by_the_way_of_the_light() {
    let found: Vec<_> = scan(&small()).readings().iter().map(degrees).collect();
    assert_eq!(found.len(), 25);
    assert_eq!(found[0], (0.0, 0.0, 180.0, 0.0));
    // The patch of the same number is the specular direction.
    assert_eq!(found[6], (40.0, 40.0, 180.0, 1.1));
    assert_eq!(found[18], (40.0, 40.0, 180.0, 3.3));
    // Row 3, the azimuth 180 deg, and column 1, the azimuth 0 of the light's way.
    assert_eq!(found[16], (40.0, 40.0, 0.0, 3.1));
    assert_eq!(found[1], (40.0, 0.0, 180.0, 0.1));
}

#[test]
fn rows_are_incident_patches_where_the_file_says_so() {
    let columns = scan(&small());
    let rows = scan(&small().replace("Columns", "Rows"));
    let at = |scan: &Measurements, psi: f64, theta: f64| {
        let found = scan.readings().iter().map(degrees);
        let found = found.filter(|reading| reading.0 == psi && reading.1 == theta);
        found.map(|reading| reading.3).collect::<Vec<_>>()
    };
    assert_eq!(at(&columns, 40.0, 0.0), [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(at(&rows, 40.0, 0.0), [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn what_is_read_and_what_is_not_is_said() {
    let blocks = ["Transmission Front", "Reflection Front", "Reflection Back"]
        .map(|direction| block(direction, &numbered()))
        .concat();
    let solar = VISIBLE.replace("Visible", "Solar");
    let all = file(
        "Columns",
        &(data(&solar, &blocks) + &data(VISIBLE, &blocks)),
    );
    let scan_of_visible = scan(&all);
    assert_eq!(scan_of_visible.readings().len(), 25);
    assert_eq!(scan_of_visible.metadata.get("sample"), Some("Test paint"));
    assert_eq!(scan_of_visible.metadata.get("spectrum"), Some("Visible"));
    let said = scan_of_visible.conversions.join("; ");
    assert!(
        said.contains("values are averages over the patches"),
        "{said}"
    );
    assert!(
        said.contains("Reflection Front of the spectrum Visible is read; 5 other blocks not read"),
        "{said}"
    );
    let back = file(
        "Columns",
        &data(&solar, &block("Reflection Back", &numbered())),
    );
    let said = scan(&back).conversions.join("; ");
    assert!(
        said.contains("Reflection Back of the spectrum Solar is read"),
        "{said}"
    );
}

#[test]
fn wavelengths_are_read_in_their_unit() {
    let at = |unit: &str, number: &str| {
        let wavelength = format!("<Wavelength unit=\"{unit}\">{number}</Wavelength>");
        data(&wavelength, &block("Reflection Front", &numbered()))
    };
    let both = at("Nanometers", "630.5") + &at("Microns", "0.85");
    let scan = scan(&file("Columns", &both));
    assert_eq!(scan.wavelengths(), [Some(0.6305), Some(0.85)]);
    let message = error(&file("Columns", &at("Angstroms", "6305")));
    assert!(
        message.contains("the wavelength \"6305\" with the unit \"Angstroms\""),
        "{message}"
    );
}

#[test]
fn known_bases_need_no_definition() {
    let values = "0.1 ".repeat(145 * 145);
    let text = small()
        .replace("Five", "LBNL/Klems Full")
        .replace(&numbered(), &values);
    // The definition in the file takes precedence.
    assert!(error(&text).contains("21025 values in ScatteringData: expected 25"));
    let (start, end) = (text.find("<AngleBasisBlock>"), text.rfind("</AngleBasis>"));
    let undefined = text[..start.unwrap()].to_owned() + &text[end.unwrap()..];
    assert_eq!(scan(&undefined).readings().len(), 145 * 145);
    // A file that names the basis in one place only.
    let once = undefined
        .replace("<ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>", "")
        .replace("<RowAngleBasis>LBNL/Klems Full</RowAngleBasis>", "");
    assert_eq!(scan(&once).readings().len(), 145 * 145);
}

#[test]
fn errors_name_line_and_value() {
    let good = small();
    let with = |from: &str, to: &str| error(&good.replacen(from, to, 1));
    assert!(with("Reflection Front", "Transmission Front").contains(
        "has Transmission Front only, which cannot be read because the model describes reflection"
    ));
    assert!(with("Columns", "TensorTree3").contains(
        "line 3: TensorTree3: a tensor tree cannot be read because its values are not those of a fixed"
    ));
    assert!(with("Columns", "Diagonal").contains("line 3: \"Diagonal\": expected Columns or Rows"));
    assert!(with("1.3", "x").contains("line 12, column ScatteringData: \"x\" is not a number"));
    assert!(
        with(" 1.3,", "")
            .contains("line 10: 24 values in ScatteringData: expected 25, one for each")
    );
    assert!(with("<ScatteringData>", "<Other>").contains("is not valid XML"));
    assert!(
        with("<ColumnAngleBasis>Five", "<ColumnAngleBasis>Six").contains(
            "line 7: the basis \"Six\" is not known: expected LBNL/Klems Full, Half or Quarter"
        )
    );
    assert!(
        with("<nPhis>4", "<nPhis>4000000000")
            .contains("line 4: nPhis: expected 1 or more, and up to")
    );
    assert!(
        with("<UpperTheta>60", "<UpperTheta>x")
            .contains("line 4: UpperTheta is missing or no number")
    );
    assert!(
        error("<a><WindowElement/></a>").contains("the root element is a: expected WindowElement")
    );
    assert!(error("<WindowElement/>").contains("has no IncidentDataStructure"));
    let solar = data(
        &VISIBLE.replace("Visible", "Solar"),
        &block("Reflection Front", &numbered()),
    );
    let several = file("Columns", &(solar.replace("Solar", "NIR") + &solar));
    assert!(
        error(&several)
            .contains("has several blocks of Reflection Front, of NIR, Solar: expected one")
    );
    let none = file("Columns", "");
    assert!(error(&none).contains("has no WavelengthDataBlock"));
    let bad = read(
        Path::new("a"),
        b"<WindowElement>\xff",
        &ReadOptions::default(),
    );
    assert!(bad.unwrap_err().to_string().contains("is not UTF-8"));
}

#[test]
fn deeply_nested_elements_are_read_or_refused() {
    let deep = "<WindowElement>".repeat(100_000);
    assert!(error(&deep).contains("is not valid XML"));
}

#[test]
fn the_angular_convention_cannot_be_chosen() {
    let options = ReadOptions {
        phi_zero: Some(Side::Forward),
        ..ReadOptions::default()
    };
    let error = read_with(&small(), &options).unwrap_err().to_string();
    assert!(
        error.contains("with azimuths of the light's way"),
        "{error}"
    );
}

#[test]
fn files_are_recognised_by_their_root() {
    assert!(is_window_element(small().as_bytes()));
    assert!(is_window_element(
        b"\xef\xbb\xbf<WindowElement xmlns=\"x\">"
    ));
    assert!(!is_window_element(b"<?xml version=\"1.0\"?><html/>"));
    assert!(!is_window_element(b"# about <WindowElement\n"));
}

proptest! {
    #[test]
    fn damaged_files_give_an_error_or_readings_in_the_domain(
        at in any::<proptest::sample::Index>(),
        length in 0..60_usize,
        by in "[0-9. \n<>/a-z-]{0,6}",
    ) {
        let mut text = small();
        let from = at.index(text.len());
        text.replace_range(from..(from + length).min(text.len()), &by);
        if let Ok(scan) = read_with(&text, &ReadOptions::default()) {
            for reading in scan.readings() {
                reading.validated().unwrap();
            }
        }
    }
}
