//! The values that options of `brdf fit` take.

use clap::ValueEnum;
use clap::builder::PossibleValuesParser;

use crate::fit::energy::DEFAULT_LIMIT_DEG;
use crate::model::Model;

/// The value of `--model`.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum ModelArgument {
    Auto,
    Given(Model),
}

/// The value of `--weights`.
#[derive(Clone, Copy, ValueEnum)]
pub(super) enum ReadingWeights {
    /// The same for all readings
    None,
    /// 1/sigma^2 by the column sigma_per_sr, from which the intervals then start
    Sigma,
    /// 1/m^2 with f_r cos theta of the model, m, and a floor of 2 % of the rms reading: for errors in
    /// proportion to the reading
    Relative,
    /// The part of the hemisphere that each reading represents
    SolidAngle,
}

/// [`DEFAULT_LIMIT_DEG`] as clap takes it.
pub(super) const DEFAULT_LIMIT: &str = "85";
const _: () = assert!(DEFAULT_LIMIT_DEG == 85.0);

pub(super) fn parse_model(text: &str) -> Result<ModelArgument, String> {
    match text {
        "auto" => Ok(ModelArgument::Auto),
        _ => text
            .parse()
            .map(ModelArgument::Given)
            .map_err(|error| format!("{error}, or auto")),
    }
}

pub(super) fn parse_limit(text: &str) -> Result<f64, String> {
    let limit: f64 = text
        .parse()
        .map_err(|_| "expected a number of degrees".to_owned())?;
    if (0.0..=90.0).contains(&limit) {
        Ok(limit)
    } else {
        Err("expected degrees from 0 to 90".to_owned())
    }
}

pub(super) fn parse_energy_limit(text: &str) -> Result<f64, String> {
    let limit = parse_limit(text)?;
    if limit < 90.0 {
        Ok(limit)
    } else {
        Err("expected degrees from 0 to below 90".to_owned())
    }
}

pub(super) fn methods_or_none() -> PossibleValuesParser {
    PossibleValuesParser::new(["levenberg-marquardt", "lm", "nelder-mead", "nm", "none"])
}
