//! Compares the ways to fit a scan.

use std::io::Write;

use super::Compared;
use super::arguments::Fitting;
use crate::cli::failure::Failure;
use crate::cli::outcome::Outcome;
use crate::cli::problems::place;
use crate::cli::stream;
use crate::fit::FitOptions;
use crate::output::print_error;
use crate::read::{LazyScan, ReadError, ReadOptions};
use crate::tradeoff::fitting::{FitTradeoff, fit_tradeoff, write_fit_tradeoffs};

/// Measures each way to fit every wavelength of a file; [`Outcome::Incomplete`] if one of them
/// cannot be fitted.
pub(super) fn compare(fitting: &Fitting) -> Compared {
    let in_use = fitting.outputs.check(Some(("FILE", &fitting.file)))?;
    let failure = |error: ReadError| vec![Failure::from(error)];
    let scans = stream::scans(&fitting.file, &ReadOptions::default()).map_err(failure)?;
    let wavelengths: Vec<Option<f64>> = scans.iter().map(LazyScan::wavelength_um).collect();
    fitting.outputs.check_figures(&wavelengths, &in_use)?;
    let options = FitOptions {
        model: fitting.model,
        refractive_index: fitting.n.clone(),
        ..FitOptions::default()
    };
    let mut trades: Vec<FitTradeoff> = Vec::new();
    let mut outcome = Outcome::Complete;
    for scan in scans {
        let at = place(&scan.source(), scan.wavelength_um());
        match fit_tradeoff(&*scan.measurements().map_err(failure)?, &options) {
            Ok(trade) => trades.push(trade),
            Err(error) if error.is_usage() => return Err(vec![Failure::from(error).at(at)]),
            Err(error) => {
                outcome = Outcome::Incomplete;
                print_error(&Failure::from(error).at(at).to_string());
            }
        }
    }
    let texts: Vec<String> = trades.iter().map(FitTradeoff::text).collect();
    let several = trades.len() > 1;
    let figures = trades
        .iter()
        .map(|trade| (trade.wavelength_um.filter(|_| several), trade.figure()));
    let csv = |writer: &mut dyn Write| write_fit_tradeoffs(&trades, writer);
    fitting
        .outputs
        .deliver(&texts.join("\n"), &trades, csv, figures.collect())?;
    Ok(outcome)
}
