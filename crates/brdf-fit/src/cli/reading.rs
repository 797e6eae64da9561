//! The options that say how files are read.

use clap::Args;

use super::failure::Failure;
use crate::format::listed;
use crate::read::{DECLARED_KEYS, LazyScan, ReadError, ReadOptions};
use crate::scan::{Format, Measurements, Side};

/// How files are read.
#[derive(Args)]
pub(super) struct ReadingArguments {
    /// Format of the files: csv, merl, astm (E1392, E2387), zemax (tabular BSDF), black-lab,
    /// goniometer (incidence angles in columns, view angles in rows), fred (tabulated BSDF), speos,
    /// lighttools, tracepro, open-material (JSON), rt300s, rgl (tensor files), klems (WINDOW XML), ssdd,
    /// or workbook (Excel, OpenDocument) [default: detected by content, then by extension]
    #[arg(long, value_name = "FORMAT")]
    pub(super) format: Option<Format>,

    /// What columns of a table are whose names do not say it, as NAME=ROLE pairs such as
    /// "Incident=psi_deg,R=reflectance_factor_percent"
    ///
    /// A role is a name that the table could have: psi_deg, theta_rad, phi_deg, mu_in, brdf_per_sr,
    /// reflectance_factor_percent, log10_brdf, wavelength_nm, sigma_per_sr, n; or ignore.
    #[arg(long, value_name = "PAIRS", value_parser = pairs)]
    columns: Option<Pairs>,

    /// State a key in place of the comments of the files, such as quantity=reflectance_factor,
    /// unit=percent, missing=-999, psi_deg=30 or wavelength_nm=632.8, or the sheet of a workbook,
    /// sheet=NAME; may be repeated
    #[arg(long, value_name = "KEY=VALUE", value_parser = declaration)]
    pub(super) declare: Vec<(String, String)>,

    /// Take all files as one scan of one sample, for example a file for each incidence
    #[arg(long)]
    pub(super) join: bool,

    /// The side of the surface normal on which the files count theta as positive: source or forward
    /// [default: source]
    #[arg(long, value_name = "SIDE")]
    pub(super) theta_positive: Option<Side>,

    /// The side on which the azimuth phi of the files is zero: source or forward [default: source]
    #[arg(long, value_name = "SIDE")]
    pub(super) phi_zero: Option<Side>,
}

impl ReadingArguments {
    /// The pairs of `--columns`.
    pub(super) fn columns(&self) -> &[(String, String)] {
        self.columns.as_ref().map_or(&[][..], |pairs| &pairs.0)
    }

    /// The options of the readers, as the command line alone states them.
    pub(super) fn options(&self) -> ReadOptions {
        ReadOptions {
            format: self.format,
            theta_positive: self.theta_positive,
            phi_zero: self.phi_zero,
            columns: self.columns().to_vec(),
            declarations: self.declare.clone(),
            ..ReadOptions::default()
        }
    }
}

/// The value of `--columns`.
#[derive(Clone, Default)]
struct Pairs(Vec<(String, String)>);

fn pairs(text: &str) -> Result<Pairs, String> {
    let pairs = text.split(',').map(|pair| {
        let (name, role) = pair
            .rsplit_once('=')
            .ok_or_else(|| format!("\"{pair}\": expected NAME=ROLE, such as Incident=psi_deg"))?;
        Ok((name.trim().to_owned(), role.trim().to_owned()))
    });
    pairs.collect::<Result<_, String>>().map(Pairs)
}

fn declaration(text: &str) -> Result<(String, String), String> {
    let (key, value) = text
        .split_once('=')
        .ok_or("expected KEY=VALUE, such as quantity=reflectance_factor")?;
    let key = key.trim().to_lowercase();
    if DECLARED_KEYS.contains(&key.as_str()) {
        Ok((key, value.trim().to_owned()))
    } else {
        let keys = DECLARED_KEYS.join(", ");
        Err(format!(
            "the key \"{key}\" is not known: expected one of {keys}"
        ))
    }
}

/// One scan of all files, for each wavelength.
pub(super) fn joined(scans: Vec<LazyScan>) -> Result<Vec<LazyScan>, Failure> {
    let names: Vec<String> = scans
        .iter()
        .map(|scan| scan.source().into_owned())
        .collect();
    let all: Result<Vec<Measurements>, ReadError> =
        scans.into_iter().map(LazyScan::into_measurements).collect();
    let Some(joined) = Measurements::joined(all?) else {
        return Err(Failure::Join.at(listed(&names, ", ")));
    };
    let each = joined.by_wavelength().into_iter();
    Ok(each.map(LazyScan::Loaded).collect())
}
