//! The 5000 points in 80-digit arithmetic, of the model of the paper.

use brdf_tests::in_workspace;

/// A point and the value there.
pub(crate) struct Reference {
    /// psi, theta and phi.
    pub(crate) angles: [f64; 3],
    /// k2, kD and k1.
    pub(crate) parameters: [f64; 3],
    /// The refractive index.
    pub(crate) n: f64,
    /// f_r.
    pub(crate) exact: f64,
}

/// All points.
pub(crate) fn reference() -> Vec<Reference> {
    let path = in_workspace("tests/data/brdf_reference.csv");
    let mut reader = csv::Reader::from_path(path).expect("the reference values");
    let rows = reader.records().map(|record| {
        let record = record.expect("a row of the reference");
        let v = |i: usize| record[i].parse::<f64>().expect("a number of the reference");
        Reference {
            angles: [v(1), v(2), v(3)],
            parameters: [v(4), v(5), v(6)],
            n: v(7),
            exact: v(8),
        }
    });
    let rows: Vec<_> = rows.collect();
    assert_eq!(rows.len(), 5000);
    rows
}
