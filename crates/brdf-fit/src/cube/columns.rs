//! What is written of each fit: a table with named columns.

use super::fit::{CubeOptions, PieceFit};
use crate::batch::StandardErrors;
use crate::model::Parameter;

/// A column of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Column {
    /// A parameter.
    Value(Parameter),
    /// E of eq. (5) in percent.
    EPercent,
    /// The standard error of a parameter for constant noise.
    Error(Parameter),
    /// The standard error of a parameter, with errors of the readings as the residuals show them.
    StandardError(Parameter),
    /// The lower end of the interval of 95 %.
    From(Parameter),
    /// The upper end of the interval of 95 %.
    To(Parameter),
    /// The number of readings that were taken and have a weight.
    Readings,
    /// What became of the scan, as a number.
    Status,
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values<'a> {
    Float(&'a [f64]),
    Count(&'a [u32]),
    Code(Vec<u8>),
}

impl Column {
    /// The columns of a run: the free parameters of the model first.
    pub(super) fn of(options: &CubeOptions) -> Vec<Self> {
        let free = || options.batch.model.free().iter().copied();
        let mut all: Vec<Self> = free().map(Self::Value).collect();
        all.push(Self::EPercent);
        if options.intervals {
            let of_one = |parameter| {
                [
                    Self::StandardError(parameter),
                    Self::From(parameter),
                    Self::To(parameter),
                ]
            };
            all.extend(free().flat_map(of_one));
        }
        if options.constant_noise_errors {
            all.extend(free().map(Self::Error));
        }
        all.extend([Self::Readings, Self::Status]);
        all
    }

    pub(super) fn name(self) -> String {
        match self {
            Self::Value(parameter) => key(parameter).to_owned(),
            Self::EPercent => "e_percent".to_owned(),
            Self::Error(parameter) => format!("{}_constant_noise_error", key(parameter)),
            Self::StandardError(parameter) => format!("{}_standard_error", key(parameter)),
            Self::From(parameter) => format!("{}_from", key(parameter)),
            Self::To(parameter) => format!("{}_to", key(parameter)),
            Self::Readings => "readings".to_owned(),
            Self::Status => "status".to_owned(),
        }
    }

    pub(super) fn values(self, piece: &PieceFit) -> Values<'_> {
        let fit = &piece.fit;
        match self {
            Self::Value(parameter) => Values::Float(match parameter {
                Parameter::K2 => &fit.k2,
                Parameter::Kd => &fit.kd,
                Parameter::K1 => &fit.k1,
                Parameter::N => &fit.n,
                Parameter::P => &fit.p,
            }),
            Self::EPercent => Values::Float(&fit.e_percent),
            Self::Error(parameter) => {
                let errors = fit.constant_noise.as_ref();
                Values::Float(errors.map_or(&[], |errors| of_parameter(errors, parameter)))
            }
            Self::StandardError(parameter) | Self::From(parameter) | Self::To(parameter) => {
                let mut all = piece.intervals.iter();
                let of_parameter = all.find(|intervals| intervals.parameter == parameter);
                Values::Float(of_parameter.map_or(&[], |intervals| match self {
                    Self::StandardError(_) => &intervals.standard_error[..],
                    Self::From(_) => &intervals.from,
                    _ => &intervals.to,
                }))
            }
            Self::Readings => Values::Count(&fit.readings),
            Self::Status => Values::Code(fit.status.iter().map(|status| *status as u8).collect()),
        }
    }
}

fn of_parameter(errors: &StandardErrors, parameter: Parameter) -> &[f64] {
    match parameter {
        Parameter::K2 => &errors.k2,
        Parameter::Kd => &errors.kd,
        Parameter::K1 => &errors.k1,
        Parameter::N => &errors.n,
        Parameter::P => &errors.p,
    }
}

/// The name of a parameter's column: in lower case, as those of the other tables.
fn key(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::K2 => "k2",
        Parameter::Kd => "kd",
        Parameter::K1 => "k1",
        Parameter::N => "n",
        Parameter::P => "p",
    }
}
