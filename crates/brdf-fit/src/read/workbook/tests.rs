//! Tests of the reader of workbooks, on workbooks that are made here.

use std::io::{Cursor, Write as _};
use std::path::Path;

use proptest::prelude::*;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::READER;
use crate::read::options::ReadOptions;
use crate::scan::{Format, Measurements};

fn read_with(bytes: &[u8], options: &ReadOptions) -> Result<Measurements, String> {
    let read = READER.read(Path::new("a.xlsx"), bytes, options);
    read.map_err(|error| error.to_string())
}

fn read(bytes: &[u8]) -> Result<Measurements, String> {
    read_with(bytes, &ReadOptions::default())
}

fn declared(key: &str, value: &str) -> ReadOptions {
    ReadOptions {
        declarations: vec![(key.to_owned(), value.to_owned())],
        ..ReadOptions::default()
    }
}

fn brdfs(scan: &Measurements) -> Vec<f64> {
    scan.readings().iter().map(|reading| reading.brdf).collect()
}

fn archive(files: &[(String, String)]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, content) in files {
        zip.start_file(name.as_str(), options).unwrap();
        zip.write_all(content.as_bytes()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// A sheet of an Excel workbook: its name, its state, its rows as XML, and what follows the rows.
struct Xlsx<'a>(&'a str, &'a str, String, &'a str);

/// The row of a table, with the cells from the first column on.
fn row(number: usize, cells: &[&str]) -> String {
    let cells = cells.iter().zip('A'..);
    let cells = cells.map(|(cell, column)| match cell.parse::<f64>() {
        _ if cell.starts_with('<') => cell.replace('@', &format!("{column}{number}")),
        Ok(_) => format!("<c r=\"{column}{number}\"><v>{cell}</v></c>"),
        Err(_) => {
            format!("<c r=\"{column}{number}\" t=\"inlineStr\"><is><t>{cell}</t></is></c>")
        }
    });
    format!("<row r=\"{number}\">{}</row>", cells.collect::<String>())
}

fn xlsx(sheets: &[Xlsx<'_>]) -> Vec<u8> {
    const MAIN: &str = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    const OFFICE: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let sheets = || sheets.iter().enumerate();
    let list: Vec<String> = sheets()
        .map(|(i, Xlsx(name, state, ..))| {
            format!("<sheet name=\"{name}\" sheetId=\"{i}\" state=\"{state}\" r:id=\"r{i}\"/>")
        })
        .collect();
    let relations: Vec<String> = sheets()
        .map(|(i, _)| {
            format!(
                "<Relationship Id=\"r{i}\" Type=\"{OFFICE}/worksheet\" Target=\"worksheets/sheet{i}.xml\"/>"
            )
        })
        .collect();
    let sheet = |(i, Xlsx(_, _, rows, after)): (usize, &Xlsx<'_>)| {
        (
            format!("xl/worksheets/sheet{i}.xml"),
            format!("<worksheet xmlns=\"{MAIN}\"><sheetData>{rows}</sheetData>{after}</worksheet>"),
        )
    };
    let mut files: Vec<_> = sheets().map(sheet).collect();
    let relations = format!(
        "<Relationships xmlns=\"r\">{}</Relationships>",
        relations.concat()
    );
    let list = list.concat();
    let workbook = format!(
        "<workbook xmlns=\"{MAIN}\" xmlns:r=\"{OFFICE}\"><sheets>{list}</sheets></workbook>"
    );
    // The second format of cells is in percent, the third a date.
    let styles = format!(
        "<styleSheet xmlns=\"{MAIN}\"><cellXfs><xf numFmtId=\"0\"/><xf numFmtId=\"10\"/>\
         <xf numFmtId=\"14\"/></cellXfs></styleSheet>"
    );
    let root = format!(
        "<Relationships xmlns=\"r\"><Relationship Id=\"r\" Type=\"{OFFICE}/officeDocument\" \
         Target=\"xl/workbook.xml\"/></Relationships>"
    );
    files.push(("_rels/.rels".to_owned(), root));
    files.push(("xl/_rels/workbook.xml.rels".to_owned(), relations));
    files.push(("xl/workbook.xml".to_owned(), workbook));
    files.push(("xl/styles.xml".to_owned(), styles));
    archive(&files)
}

const HEADER: [&str; 3] = ["psi_deg", "theta_deg", "brdf_per_sr"];

fn scan_of(brdf: &str) -> String {
    row(1, &HEADER) + &row(2, &["10", "-10", brdf])
}

fn one_sheet(rows: String) -> Vec<u8> {
    xlsx(&[Xlsx("Scan", "visible", rows, "")])
}

#[test]
fn a_sheet_is_a_table_whose_lines_are_its_rows() {
    let rows = row(2, &["# sample: Red &quot;A&quot;"])
        + &row(3, &["# wavelength_um: 0.63"])
        + &row(5, &HEADER)
        + &row(6, &["10", "-10", "0.1234567890123456"])
        + &row(8, &["10", "20", "630.78999999999996"]);
    let scan = read(&one_sheet(rows.clone())).unwrap();
    assert_eq!(brdfs(&scan), [0.123_456_789_012_345_6, 630.79]);
    assert_eq!(scan.wavelengths(), [Some(0.63)]);
    assert_eq!(scan.metadata.get("sample"), Some("Red \"A"));
    assert_eq!(scan.source, "a.xlsx");
    assert_eq!(scan.format, Format::Workbook);
    assert_eq!(scan.conversions, [""; 0]);
    let error = read(&one_sheet(rows + &row(9, &["10", "x", "0.1"]))).unwrap_err();
    assert_eq!(
        error,
        "a.xlsx, sheet \"Scan\", line 9, column theta_deg: \"x\" is not a number: expected the view \
         angle in degrees"
    );
}

#[test]
fn the_sheet_with_readings_is_read_and_the_others_are_named() {
    let notes = || row(1, &["Measured", "on a day"]);
    let book = xlsx(&[
        Xlsx("Notes", "visible", notes(), ""),
        Xlsx("Scan", "visible", scan_of("0.1"), ""),
        Xlsx("Old", "hidden", scan_of("0.2"), ""),
    ]);
    let scan = read(&book).unwrap();
    assert_eq!(brdfs(&scan), [0.1]);
    assert_eq!(
        scan.conversions,
        ["the sheet \"Scan\" is read, \"Notes\", \"Old\" (hidden) are not"]
    );
    let old = read_with(&book, &declared("sheet", " old")).unwrap();
    assert_eq!(brdfs(&old), [0.2]);
    let hidden_alone = xlsx(&[
        Xlsx("Notes", "visible", notes(), ""),
        Xlsx("Old", "veryHidden", scan_of("0.2"), ""),
    ]);
    let scan = read(&hidden_alone).unwrap();
    assert_eq!(
        scan.conversions,
        ["the sheet \"Old\" (hidden) is read, \"Notes\" is not"]
    );
}

#[test]
fn several_sheets_with_readings_are_an_error_that_asks() {
    let book = xlsx(&[
        Xlsx("Red", "visible", scan_of("0.1"), ""),
        Xlsx("Blue", "visible", scan_of("0.2"), ""),
    ]);
    assert_eq!(
        read(&book).unwrap_err(),
        "a.xlsx: several sheets hold readings: \"Red\", \"Blue\": expected a declaration of one, such \
         as sheet=Red"
    );
    let blue = read_with(&book, &declared("sheet", "Blue")).unwrap();
    assert_eq!(brdfs(&blue), [0.2]);
    let error = read_with(&book, &declared("sheet", "Green")).unwrap_err();
    assert!(
        error.ends_with("has no sheet \"Green\" with cells: the sheets are \"Red\", \"Blue\""),
        "{error}"
    );
}

#[test]
fn sheets_without_readings_say_what_is_missing() {
    let notes = || row(1, &["Measured", "on a day"]);
    let one = read(&one_sheet(notes())).unwrap_err();
    assert!(
        one.starts_with("a.xlsx, sheet \"Scan\": has no header: expected a line"),
        "{one}"
    );
    let two = xlsx(&[
        Xlsx("A", "visible", notes(), ""),
        Xlsx("B", "visible", notes(), ""),
    ]);
    let two = read(&two).unwrap_err();
    assert!(
        two.contains("no sheet holds readings with columns that are known: \"A\", \"B\""),
        "{two}"
    );
    let none = read(&one_sheet(String::new())).unwrap_err();
    assert!(none.starts_with("a.xlsx: is empty"), "{none}");
    // The options may say what the columns are.
    let rows = row(1, &["Incident", "theta_r", "brdf"]) + &row(2, &["10", "20", "0.5"]);
    let rows = rows.replace("Incident", "Lamp");
    let book = xlsx(&[
        Xlsx("A", "visible", notes(), ""),
        Xlsx("B", "visible", rows, ""),
    ]);
    let options = ReadOptions {
        columns: vec![("Lamp".to_owned(), "psi_deg".to_owned())],
        ..ReadOptions::default()
    };
    assert_eq!(brdfs(&read_with(&book, &options).unwrap()), [0.5]);
}

#[test]
fn percentages_are_of_the_columns_quantity() {
    let percent = "<c r=\"@\" s=\"1\"><v>0.07</v></c>";
    let with = |name| row(1, &["psi_deg", "theta_deg", name]) + &row(2, &["10", "20", percent]);
    for name in ["reflectance_factor", "R%"] {
        let scan = read(&one_sheet(with(name))).unwrap();
        assert_eq!(brdfs(&scan), [0.07 / std::f64::consts::PI], "{name}");
    }
    let error = read(&one_sheet(with("brdf"))).unwrap_err();
    assert!(
        error.ends_with(
            "line 2, column brdf: \"7%\" is a percentage: expected a number, because the \
                         column holds f_r"
        ),
        "{error}"
    );
}

#[test]
fn cells_that_are_no_numbers_are_errors_or_readings_not_taken() {
    let with = |cell: &str| {
        let rows = scan_of("0.1") + &row(3, &["10", "20", cell]);
        read(&one_sheet(rows))
    };
    let scan = with("<c r=\"@\" t=\"e\"><v>#N/A</v></c>").unwrap();
    assert_eq!(
        scan.conversions,
        ["1 reading not taken (no value) is left out"]
    );
    for (cell, shown) in [
        ("<c r=\"@\" t=\"e\"><v>#DIV/0!</v></c>", "#DIV/0!"),
        ("<c r=\"@\" t=\"b\"><v>1</v></c>", "TRUE"),
        ("<c r=\"@\" s=\"2\"><v>45000</v></c>", "2023-03-15"),
        ("<c r=\"@\"><f>A1+1</f></c>", "(formula without a result)"),
        (
            "<c r=\"@\"><f>A1+1</f><v></v></c>",
            "(formula without a result)",
        ),
    ] {
        let error = with(cell).unwrap_err();
        assert!(
            error.contains(&format!(
                "line 3, column brdf_per_sr: \"{shown}\" is not a number"
            )),
            "{error}"
        );
    }
    let result = with("<c r=\"@\"><f>0.1+0.1</f><v>0.2</v></c>").unwrap();
    assert_eq!(brdfs(&result), [0.1, 0.2]);
    // An error in the first column does not make the row a comment.
    let rows = scan_of("0.1") + &row(3, &["<c r=\"@\" t=\"e\"><v>#REF!</v></c>", "1", "0.1"]);
    let error = read(&one_sheet(rows)).unwrap_err();
    assert!(
        error.contains("line 3, column psi_deg: \"#REF!\" is not a number"),
        "{error}"
    );
}

#[test]
fn merged_incidences_hold_for_all_their_rows() {
    let rows = row(1, &HEADER)
        + &row(2, &["10", "-10", "0.1"])
        + &row(3, &["<c r=\"@\"/>", "20", "0.2"])
        + &row(4, &["30", "-30", "0.3"]);
    let merged = "<mergeCells count=\"1\"><mergeCell ref=\"A2:A3\"/></mergeCells>";
    let scan = read(&xlsx(&[Xlsx("Scan", "visible", rows, merged)])).unwrap();
    assert_eq!(scan.readings()[1].psi, 10_f64.to_radians());
    assert_eq!(
        scan.conversions,
        ["1 cell has the value of the cell that it is merged with"]
    );
}

#[test]
fn cells_in_opposite_corners_do_not_fill_the_memory() {
    let far = "<row r=\"1048576\"><c r=\"XFD1048576\"><v>1</v></c></row>";
    let error = read(&one_sheet(scan_of("0.1") + far)).unwrap_err();
    assert!(
        error.contains("line 1048576: 16384 fields: expected 3"),
        "{error}"
    );
}

#[test]
fn damaged_workbooks_are_errors() {
    let book = one_sheet(scan_of("0.1"));
    for end in [40, book.len() / 2, book.len() - 30] {
        let error = read(&book[..end]).unwrap_err();
        assert!(
            error.contains("is damaged") || error.contains("is not a workbook"),
            "{error}"
        );
    }
    let binary = archive(&[("xl/workbook.bin".to_owned(), String::new())]);
    assert!(read(&binary).unwrap_err().contains("(.xlsb)"));
    let mut compound = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1".to_vec();
    compound.resize(2000, 0);
    assert!(read(&compound).unwrap_err().contains("is damaged"));
    assert!(read(b"psi_deg").unwrap_err().contains("is not a workbook"));
}

#[test]
fn an_archive_is_limited_by_what_it_unpacks_to() {
    let book = one_sheet(scan_of("0.1"));
    assert!(super::archive::open_within(&book, 5000).is_ok());
    let error = super::archive::open_within(&book, 100).unwrap_err();
    assert!(error.contains("when it is unpacked"), "{error}");
}

/// An OpenDocument workbook with a sheet of rows as XML.
fn ods(rows: &str) -> Vec<u8> {
    let content = format!(
        "<office:document-content xmlns:office=\"o\" xmlns:table=\"t\" xmlns:text=\"x\" \
         xmlns:style=\"s\" xmlns:calcext=\"c\"><office:automatic-styles><style:style \
         style:name=\"h\"><style:table-properties table:display=\"false\"/></style:style>\
         </office:automatic-styles><office:body><office:spreadsheet><table:table \
         table:name=\"Scan\"><table:table-column/>{rows}</table:table><table:table \
         table:name=\"Old\" table:style-name=\"h\"/></office:spreadsheet></office:body>\
         </office:document-content>"
    );
    ods_of(content)
}

fn ods_of(content: String) -> Vec<u8> {
    let mimetype = "application/vnd.oasis.opendocument.spreadsheet";
    archive(&[
        ("mimetype".to_owned(), mimetype.to_owned()),
        ("content.xml".to_owned(), content),
    ])
}

const ODS_HEADER: &str = "<table:table-row><table:table-cell><text:p>psi<text:s/>(deg)</text:p>\
    </table:table-cell><table:table-cell><text:p>theta_deg</text:p></table:table-cell><table:table-cell>\
    <office:annotation><text:p>a note</text:p></office:annotation><text:p>reflectance \
    <text:span>factor</text:span></text:p></table:table-cell></table:table-row>";

fn number(value: &str) -> String {
    format!("<table:table-cell office:value-type=\"float\" office:value=\"{value}\"/>")
}

#[test]
fn open_document_sheets_have_repeated_cells_percentages_and_merged_cells() {
    let merged = number("10").replace(
        "office:value=",
        "table:number-rows-spanned=\"2\" office:value=",
    );
    let percent = "<table:table-cell office:value-type=\"percentage\" office:value=\"0.07\"><text:p>7%\
                   </text:p></table:table-cell>";
    let covered = "<table:covered-table-cell/>";
    let twice = "<table:table-cell office:value-type=\"float\" office:value=\"20\" \
                 table:number-columns-repeated=\"2\"/>";
    let rows = format!(
        "{ODS_HEADER}<table:table-row table:number-rows-repeated=\"3\"/><table:table-row>{merged}{}\
         {percent}</table:table-row><table:table-row-group><table:table-row>{covered}{}{}\
         </table:table-row></table:table-row-group><table:table-row table:number-rows-repeated=\"2\">\
         {twice}{}</table:table-row><table:table-row table:number-rows-repeated=\"1048000\">\
         <table:table-cell table:number-columns-repeated=\"16384\"/></table:table-row>",
        number("-10"),
        number("30"),
        number("0.5"),
        number("0.25"),
    );
    let scan = read(&ods(&rows)).unwrap();
    let factors: Vec<f64> = brdfs(&scan)
        .iter()
        .map(|f| f * std::f64::consts::PI)
        .collect();
    assert_eq!(factors.len(), 4);
    for (found, expected) in factors.iter().zip([0.07, 0.5, 0.25, 0.25]) {
        assert!((found - expected).abs() < 1e-15, "{factors:?}");
    }
    assert_eq!(scan.readings()[1].psi, 10_f64.to_radians());
    let notes = &scan.conversions[..2];
    assert_eq!(
        notes,
        [
            "the sheet \"Scan\" is read, \"Old\" (hidden) is not",
            "1 cell has the value of the cell that it is merged with"
        ]
    );
}

#[test]
fn cells_of_open_document_that_are_no_numbers_say_so() {
    let with = |cell: &str| {
        let row = format!(
            "<table:table-row>{}{}{cell}</table:table-row>",
            number("10"),
            number("20")
        );
        read(&ods(&format!("{ODS_HEADER}{row}"))).unwrap_err()
    };
    for (cell, shown) in [
        (
            "<table:table-cell office:value-type=\"date\" office:date-value=\"2024-05-17\"/>",
            "2024-05-17",
        ),
        (
            "<table:table-cell office:value-type=\"boolean\" office:boolean-value=\"true\"/>",
            "TRUE",
        ),
        (
            "<table:table-cell office:value-type=\"float\" office:value=\"0\" \
             calcext:value-type=\"error\"><text:p>Err:502</text:p></table:table-cell>",
            "Err:502",
        ),
        (
            "<table:table-cell table:formula=\"of:=1+1\"/>",
            "(formula without a result)",
        ),
        (
            "<table:table-cell office:value-type=\"string\"><text:p>a &lt; &#98;</text:p></table:table-cell>",
            "a < b",
        ),
    ] {
        let error = with(cell);
        assert!(
            error.contains(&format!("line 2, column reflectance factor: \"{shown}\"")),
            "{error}"
        );
    }
    assert!(with(&number("x")).contains("the value \"x\" is not a number"));
    let times = "<table:table-cell table:number-columns-repeated=\"0\"/>";
    assert!(with(times).contains("number-columns-repeated=\"0\": expected a number of cells"));
}

#[test]
fn an_open_document_that_is_cut_off_or_too_large_ends() {
    let cut =
        "<office:document-content><office:body><office:spreadsheet><table:table><table:table-row>";
    assert!(
        read(&ods_of(cut.to_owned()))
            .unwrap_err()
            .contains("ends too early")
    );
    let row = "<table:table-row table:number-rows-repeated=\"1048576\"><table:table-cell \
               office:value-type=\"float\" office:value=\"1\" table:number-columns-repeated=\"16384\"/>\
               </table:table-row>";
    let error = read(&ods(row)).unwrap_err();
    assert!(error.contains("more than 10000000 cells"), "{error}");
    let far = "<table:table-row table:number-rows-repeated=\"1048576\"/>".to_owned() + ODS_HEADER;
    assert!(read(&ods(&far)).unwrap_err().contains("beyond row 1048576"));
    let manifest = "<manifest:encryption-data/>".to_owned();
    let locked = archive(&[
        (
            "mimetype".to_owned(),
            "application/vnd.oasis.opendocument.spreadsheet".to_owned(),
        ),
        ("META-INF/manifest.xml".to_owned(), manifest),
    ]);
    assert!(
        read(&locked)
            .unwrap_err()
            .contains("protected by a password")
    );
}

/// A record of a workbook of Excel 97.
fn record(kind: u16, data: &[u8]) -> Vec<u8> {
    let length = u16::try_from(data.len()).unwrap();
    [&kind.to_le_bytes(), &length.to_le_bytes(), data].concat()
}

/// The data of a record from numbers of 16 bits, and what follows them.
fn fields(numbers: &[u16], after: &[u8]) -> Vec<u8> {
    let numbers = numbers.iter().flat_map(|number| number.to_le_bytes());
    numbers.chain(after.iter().copied()).collect()
}

const BOF: u16 = 0x0809;

/// The records of a workbook of Excel 97 with a table of strings and a sheet of cells.
fn biff(version: u16, cells: &[Vec<u8>]) -> Vec<u8> {
    let globals = |start: u32| {
        let mut strings = fields(&[5, 0, 5, 0], b"");
        for text in ["psi_deg", "theta_deg", "R%", "#N/A"] {
            let length = u16::try_from(text.len()).unwrap();
            strings.extend(fields(&[length], b"\0"));
            strings.extend(text.as_bytes());
        }
        // The last string goes on in the next record.
        strings.extend(fields(&[4], b"\0# "));
        let sheet = [&start.to_le_bytes()[..], b"\0\0\x04\0Scan"].concat();
        let format = fields(&[164, 5], b"\x000.00%");
        [
            record(BOF, &fields(&[version, 5], b"")),
            record(0x0022, &fields(&[0], b"")),
            record(0x041e, &format),
            record(0x00e0, &fields(&[0, 0], b"")),
            record(0x00e0, &fields(&[0, 164], b"")),
            record(0x00e0, &fields(&[0, 14], b"")),
            record(0x0085, &sheet),
            record(0x00fc, &strings),
            record(0x003c, b"\x01a\0:\0"),
            record(0x000a, b""),
        ]
        .concat()
    };
    let length = u32::try_from(globals(0).len()).unwrap();
    let mut stream = globals(length);
    stream.extend(record(BOF, &fields(&[version, 16], b"")));
    stream.extend(cells.concat());
    stream.extend(record(0x000a, b""));
    stream
}

fn compound(stream: &str, content: &[u8]) -> Vec<u8> {
    let mut file = cfb::CompoundFile::create(Cursor::new(Vec::new())).unwrap();
    file.create_stream(stream)
        .unwrap()
        .write_all(content)
        .unwrap();
    file.into_inner().into_inner()
}

fn string_cell(row: u16, column: u16, string: u16) -> Vec<u8> {
    record(0x00fd, &fields(&[row, column, 0, string, 0], b""))
}

fn number_cell(row: u16, column: u16, format: u16, number: f64) -> Vec<u8> {
    record(
        0x0203,
        &fields(&[row, column, format], &number.to_le_bytes()),
    )
}

fn xls_cells() -> Vec<Vec<u8>> {
    let integer = |number: u32, hundredth: u32| (number << 2 | 2 | hundredth).to_le_bytes();
    let float = u32::try_from(20_f64.to_bits() >> 32).unwrap().to_le_bytes();
    vec![
        string_cell(0, 0, 4),
        string_cell(1, 0, 0),
        string_cell(1, 1, 1),
        string_cell(1, 2, 2),
        // A chart within the sheet is skipped.
        record(BOF, &fields(&[0x0600, 32], b"")),
        number_cell(0, 0, 0, 5.0),
        record(0x000a, b""),
        record(
            0x00bd,
            &fields(
                &[2, 0, 0],
                &[
                    &integer(10, 0)[..],
                    &fields(&[0], &float),
                    &fields(&[1], b""),
                ]
                .concat(),
            ),
        ),
        number_cell(2, 2, 1, 0.07),
        record(0x027e, &fields(&[3, 1, 0], &integer(1550, 1))),
        record(0x0006, &fields(&[3, 2, 0], &12.5_f64.to_le_bytes())),
        number_cell(4, 0, 0, 30.0),
        number_cell(4, 1, 0, 30.0),
        record(0x0006, &fields(&[4, 2, 0], b"\0\0\0\0\0\0\xff\xff")),
        record(0x0207, b"\x04\0\0#N/A"),
        record(0x00e5, &fields(&[1, 2, 3, 0, 0], b"")),
    ]
}

#[test]
fn sheets_of_old_excel_have_numbers_strings_and_results_of_formulas() {
    let bytes = compound("/Workbook", &biff(0x0600, &xls_cells()));
    let scan = read(&bytes).unwrap();
    let percent: Vec<f64> = brdfs(&scan)
        .iter()
        .map(|f| 100.0 * f * std::f64::consts::PI)
        .collect();
    assert_eq!(percent.len(), 2);
    assert!(
        (percent[0] - 7.0).abs() < 1e-14 && (percent[1] - 12.5).abs() < 1e-14,
        "{percent:?}"
    );
    let second = scan.readings()[1];
    assert_eq!(second.psi, 10_f64.to_radians());
    assert_eq!(second.theta, 15.5_f64.to_radians());
    assert!(
        scan.conversions
            .contains(&"1 reading not taken (no value) is left out".to_owned())
    );
}

#[test]
fn dates_truth_values_and_errors_of_old_excel_are_no_numbers() {
    let with = |cell: Vec<u8>| {
        let cells = [
            vec![
                string_cell(1, 0, 0),
                string_cell(1, 1, 1),
                string_cell(1, 2, 2),
            ],
            vec![number_cell(2, 0, 0, 10.0), number_cell(2, 1, 0, 20.0), cell],
        ]
        .concat();
        read(&compound("/Workbook", &biff(0x0600, &cells))).unwrap_err()
    };
    for (cell, shown) in [
        (number_cell(2, 2, 2, 45_000.0), "2023-03-15"),
        (record(0x0205, &fields(&[2, 2, 0], b"\x01\0")), "TRUE"),
        (record(0x0205, &fields(&[2, 2, 0], b"\x07\x01")), "#DIV/0!"),
        (
            record(0x0006, &fields(&[2, 2, 0], b"\x02\0\x24\0\0\0\xff\xff")),
            "#NUM!",
        ),
        (
            record(0x0006, &fields(&[2, 2, 0], b"\x01\0\0\0\0\0\xff\xff")),
            "FALSE",
        ),
        (record(0x0204, &fields(&[2, 2, 0, 2], b"\0no")), "no"),
    ] {
        let error = with(cell);
        assert!(
            error.contains(&format!("line 3, column R%: \"{shown}\"")),
            "{error}"
        );
    }
}

#[test]
fn old_encrypted_and_foreign_compound_files_are_called_by_their_names() {
    let old = compound("/Book", &biff(0x0500, &[]));
    assert!(read(&old).unwrap_err().contains("Excel 95 or earlier"));
    let locked = compound("/EncryptedPackage", b"x");
    assert!(
        read(&locked)
            .unwrap_err()
            .contains("protected by a password")
    );
    let stream = [
        record(BOF, &fields(&[0x0600, 5], b"")),
        record(0x002f, &[1, 0]),
    ]
    .concat();
    assert!(
        read(&compound("/Workbook", &stream))
            .unwrap_err()
            .contains("protected by a password")
    );
    let letter = compound("/WordDocument", b"x");
    assert!(read(&letter).unwrap_err().contains("without a workbook"));
}

#[test]
fn sheets_that_overlap_are_an_error() {
    let sheet = |start: u32| record(0x0085, &[&start.to_le_bytes()[..], b"\0\0\x01\0A"].concat());
    let globals = |start: u32| {
        let sheets = sheet(start).repeat(20);
        [
            record(BOF, &fields(&[0x0600, 5], b"")),
            sheets,
            record(0x000a, b""),
        ]
        .concat()
    };
    let start = u32::try_from(globals(0).len()).unwrap();
    let mut stream = globals(start);
    stream.extend(record(BOF, &fields(&[0x0600, 16], b"")));
    stream.extend(record(0x0201, &[0; 6]).repeat(100));
    stream.extend(record(0x000a, b""));
    assert!(
        read(&compound("/Workbook", &stream))
            .unwrap_err()
            .contains("sheets overlap")
    );
}

/// Cells and markup of workbooks, in any order.
fn word() -> impl Strategy<Value = String> {
    let known = [
        "<row r=\"5\">",
        "</row>",
        "<c r=\"B2\">",
        "<c>",
        "</c>",
        "<v>",
        "</v>",
        "1",
        "psi_deg",
        "<f>",
        "</f>",
        "<c r=\"XFD9999999\" t=\"s\">",
        "<table:table-row>",
        "</table:table-row>",
        "&amp;",
        "&x;",
        "<table:table-cell office:value=\"1\" office:value-type=\"float\"/>",
        "<text:p>",
        "</text:p>",
        "<table:table-row table:number-rows-repeated=\"1000000\"/>",
        "<!--",
        "-->",
        "<![CDATA[",
        "]]>",
    ];
    proptest::sample::select(known.to_vec()).prop_map(str::to_owned)
}

proptest! {
    #[test]
    fn any_markup_is_read_or_refused(words in proptest::collection::vec(word(), 0..40)) {
        let rows = words.concat();
        for book in [one_sheet(scan_of("0.1") + &rows), ods(&format!("{ODS_HEADER}{rows}"))] {
            if let Ok(scan) = read(&book) {
                prop_assert!(!scan.readings().is_empty());
            }
        }
    }

    #[test]
    fn any_records_are_read_or_refused(
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..4),
        in_stream in any::<bool>(),
    ) {
        let mut stream = biff(0x0600, &xls_cells());
        let damage = |bytes: &mut Vec<u8>| {
            for (at, byte) in &changes {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
        };
        if in_stream {
            damage(&mut stream);
        }
        let mut book = compound("/Workbook", &stream);
        if !in_stream {
            damage(&mut book);
        }
        if let Ok(scan) = read(&book) {
            for reading in scan.readings() {
                reading.validated().unwrap();
            }
        }
    }
}
