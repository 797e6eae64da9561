//! The project's own data: Table 1 as CSV, and scans computed from it.

use std::fmt::Write as _;

use brdf_core::published::{PUBLISHED, PublishedSample};
use brdf_fit::synthetic::scan;

use crate::{generator, normal};

/// The command that writes these files, as it stands in them.
const COMMAND: &str = "cargo run --release -p brdf-tests --bin make-data";

/// Relative noise of the noisy scan.
const NOISE: f64 = 0.05;

/// Every generated file: its path below the workspace's root, and its text.
pub fn files() -> Vec<(String, String)> {
    let mut files = vec![("data/published/table1.csv".to_owned(), table_1())];
    for row in PUBLISHED {
        let name = format!(
            "data/synthetic/table1_{}_{}um.csv",
            row.sample, row.wavelength_um
        );
        files.push((name, synthetic(&row, 0.0)));
    }
    let noisy = synthetic(&PUBLISHED[4], NOISE);
    files.push((
        "data/synthetic/table1_003_0.91um_noise5.csv".to_owned(),
        noisy,
    ));
    files
}

fn table_1() -> String {
    let mut text = format!(
        "# source: Li Tie, Yan Wei, Wu Zhensen, Acta Optica Sinica 22(7), 769-773 (2002), Table 1\n\
         # made by: {COMMAND}\n\
         sample,coating,base,wavelength_um,n,k2,kd,k1,e_percent\n"
    );
    for row in PUBLISHED {
        let PublishedSample {
            sample,
            coating,
            base,
            wavelength_um,
            n,
            e_percent,
            ..
        } = row;
        let (k2, kd, k1) = (row.parameters.k2, row.parameters.kd, row.parameters.k1);
        let _ = writeln!(
            text,
            "{sample},{coating},{base},{wavelength_um},{n},{k2},{kd},{k1},{e_percent}"
        );
    }
    text
}

fn synthetic(row: &PublishedSample, noise: f64) -> String {
    let PublishedSample {
        sample,
        coating,
        wavelength_um,
        n,
        ..
    } = row;
    let kind = if noise == 0.0 {
        "no noise".to_owned()
    } else {
        format!("{} % noise", 100.0 * noise)
    };
    let mut text = format!(
        "# sample: SYNTHETIC, not measured: {sample} {coating} at {wavelength_um} um, {kind}\n\
         # source: computed by eq. (4) from Table 1 of Li, Yan and Wu (2002)\n\
         # made by: {COMMAND}\n\
         # quantity: brdf\n\
         # refractive_index: {n}\n\
         wavelength_um,psi_deg,theta_deg,brdf_per_sr\n"
    );
    let mut generator = generator(1);
    for reading in scan(row.parameters, *n).readings() {
        let brdf = if noise == 0.0 {
            reading.brdf.to_string()
        } else {
            format!(
                "{:.6}",
                reading.brdf * (1.0 + noise * normal(&mut generator))
            )
        };
        let (psi, theta) = (
            reading.psi.to_degrees().round(),
            reading.theta.to_degrees().round(),
        );
        let _ = writeln!(text, "{wavelength_um},{psi},{theta},{brdf}");
    }
    text
}
