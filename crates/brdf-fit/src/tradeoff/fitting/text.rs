//! The table of a trade-off of fitting.

use std::fmt::Write as _;

use super::result::{Alternative, FitTradeoff, Measured, OfParameter, Outcome};
use crate::format::{counted, digits, rounded, shortest};

/// Shifts of at least this many standard errors are written in scientific notation.
const FAR: f64 = 1e4;

impl FitTradeoff {
    /// The table as text: the reference, and a line for each alternative.
    pub fn text(&self) -> String {
        let mut text = self.heading();
        text += &self.columns();
        for alternative in &self.alternatives {
            text += &line(alternative);
        }
        text + NOTES
    }

    fn heading(&self) -> String {
        let sample = self.sample.as_ref();
        let sample = sample.map_or_else(String::new, |sample| format!(": {sample}"));
        let wavelength = self
            .wavelength_um
            .map_or_else(|| "wavelength not stated".to_owned(), |w| format!("{w} um"));
        let reference = &self.reference;
        format!(
            "{}{sample}\n  {wavelength}, n = {}, {} of {}\n  reference: {}, E = {} %\n\n",
            self.source,
            shortest(reference.parameters.n),
            counted(reference.readings, "reading"),
            counted(reference.incidences, "incidence"),
            self.reference_parameters(),
            digits(reference.e_percent),
        )
    }

    /// `k2 = 0.02286 +- 0.00050, ...`
    fn reference_parameters(&self) -> String {
        let reference = &self.reference;
        let values = reference.standard_errors.iter().map(|of| {
            let value = of.parameter.of(&reference.parameters);
            match of.value {
                None => format!("{} = {}", of.parameter, digits(value)),
                Some(error) => format!(
                    "{} = {} +- {}",
                    of.parameter,
                    rounded(value, error),
                    rounded(error, error)
                ),
            }
        });
        values.collect::<Vec<_>>().join(", ")
    }

    fn columns(&self) -> String {
        let mut text = format!(
            "  {:<31}{:>9}{:>6}{:>11}{:>11}{:>13}",
            "", "readings", "inc.", "time us", "E all %", "excess E"
        );
        for of in &self.reference.standard_errors {
            let _ = write!(text, "{:>9}", format!("d {}", of.parameter));
        }
        text + "  ended by\n"
    }
}

const NOTES: &str = "  \
  (*: on the Pareto front, no alternative is faster without a higher E; time: median of several runs on
  one thread; excess E: E over all readings / lowest - 1; d: shift from the reference in its standard
  errors; LM: Levenberg-Marquardt, NM: Nelder-Mead; check: the search over k1; iterations: the limit of
  each stage)
";

fn line(alternative: &Alternative) -> String {
    let front = match alternative.measured() {
        Some(measured) if measured.pareto => "*",
        _ => " ",
    };
    let (readings, incidences) = (alternative.readings, alternative.incidences);
    let name = &alternative.name;
    let rest = match &alternative.outcome {
        Outcome::Fitted(measured) => numbers(measured),
        Outcome::Failed { error } => format!("  not fitted: {error}"),
    };
    format!("{front} {name:<31}{readings:>9}{incidences:>6}{rest}\n")
}

fn numbers(measured: &Measured) -> String {
    let mut text = format!(
        "{:>11.1}{:>11}{:>13}",
        1e6 * measured.seconds,
        digits(measured.e_percent),
        digits(measured.excess_e)
    );
    for of in &measured.shift_in_sigma {
        let _ = write!(text, "{:>9}", shift(of));
    }
    let _ = write!(text, "  {}", measured.ended_by);
    text
}

/// A shift to two decimals; one below them is `0`.
fn shift(of: &OfParameter) -> String {
    match of.value {
        None => "-".to_owned(),
        Some(shift) if shift.abs() < 0.005 => "0".to_owned(),
        Some(shift) if shift.abs() < FAR => format!("{shift:+.2}"),
        Some(shift) => format!("{shift:+.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Parameter;

    #[test]
    fn shifts_are_short() {
        let of = |value| {
            shift(&OfParameter {
                parameter: Parameter::K2,
                value,
            })
        };
        assert_eq!(of(None), "-");
        assert_eq!(of(Some(-1e-12)), "0");
        assert_eq!(of(Some(-0.123)), "-0.12");
        assert_eq!(of(Some(123_456.0)), "+1.2e5");
    }
}
