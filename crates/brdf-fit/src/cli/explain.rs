//! The errors and warnings of the library, with the options by which a user of the command line can
//! remove their cause.

use std::fmt::Display;

use crate::cube::CubeError;
use crate::export::{ExportError, MaterialError, SelectionError};
use crate::fit::FitError;
use crate::inference::{Hint, Warning};
use crate::objective::ObjectiveError;
use crate::planning::PlanError;
use crate::read::{ReadError, Remedy};
use crate::report::DocumentError;
use crate::tradeoff::fitting::TradeoffError;

/// A message with a hint behind it, unless the message contains the hint's first option.
fn with_hint(message: impl Display, hint: &str) -> String {
    let message = message.to_string();
    let mut words = hint.split([' ', ',', '=']);
    let option = words.find(|word| word.starts_with("--"));
    if option.is_some_and(|option| message.contains(option)) {
        message
    } else {
        format!("{message} ({hint})")
    }
}

/// Why a scan cannot be fitted. The wavelength is left out: the message is printed behind the file
/// and its wavelengths.
pub(super) fn fit(error: &FitError) -> String {
    let hint = match error {
        FitError::NoRefractiveIndex(_) => {
            return "no refractive index: give it with --n 1.5 or --n 0.63=1.60,0.85=1.58, by a \
                    column n, or by a line \"# refractive_index: 1.5\" in the file"
                .to_owned();
        }
        FitError::RefractiveIndex(_) => "--n",
        FitError::EnergyLimit(_) => "--energy-conserving",
        FitError::Objective(ObjectiveError::NoSigma) => "--weights sigma",
        FitError::NoStage => "--stage1, --stage2",
        FitError::Stage1Alone(_) => "--stage2 none leaves stage 1, up to --stage1-limit, alone",
        FitError::Fixed(_) => "--fix",
        FitError::FixedAboveEnergy(_) => "--fix together with --energy-conserving",
        _ => return error.to_string(),
    };
    with_hint(error, hint)
}

/// Why a file cannot be read.
pub(super) fn read(error: &ReadError) -> String {
    let hint = match error.remedy() {
        Some(Remedy::Columns) => "--columns \"NAME=ROLE\"",
        Some(Remedy::Incidence) => "or --declare psi_deg=30",
        Some(Remedy::ColumnAngles) => "or --declare columns=incidence",
        Some(Remedy::PhiZero) => "--phi-zero source or --phi-zero forward",
        Some(Remedy::Sheet) => "--declare sheet=NAME",
        Some(Remedy::Missing) => "or --declare missing=VALUE",
        _ => return error.to_string(),
    };
    with_hint(error, hint)
}

/// Why the scans of an array cannot be fitted.
pub(super) fn cube(error: &CubeError) -> String {
    match error {
        CubeError::Ambiguous { .. } => with_hint(error, "--axis DIMENSION"),
        _ => error.to_string(),
    }
}

/// Which outputs of the fits of an array there are.
pub(super) fn cube_output() -> &'static str {
    if cfg!(feature = "parquet") {
        "expected a name that ends in .npy or .parquet for --output"
    } else {
        "expected a name that ends in .npy for --output (a program built with --features parquet also writes \
         .parquet)"
    }
}

/// Why the ways to fit a scan cannot be compared.
pub(super) fn tradeoff(error: &TradeoffError) -> String {
    match error {
        TradeoffError::Fit(error) => fit(error),
        _ => error.to_string(),
    }
}

/// Why readings cannot be planned.
pub(super) fn plan(error: &PlanError) -> String {
    match error {
        PlanError::Fit(error) => fit(error),
        PlanError::Wavelengths(_) => with_hint(error, "--wavelength UM chooses one"),
        PlanError::NoSetting => with_hint(
            error,
            "--incidence, --view, --from-source, --largest-incidence, --largest-view, --step-incidence, --step-view",
        ),
        _ => error.to_string(),
    }
}

/// Why the result of an earlier run cannot be read.
pub(super) fn document(error: &DocumentError) -> String {
    match error {
        DocumentError::Json { .. } => with_hint(error, "brdf fit writes it with --json"),
        _ => error.to_string(),
    }
}

/// Why a material cannot be read, or not be chosen from a file.
pub(super) fn material(error: &MaterialError) -> String {
    let hint = match error {
        MaterialError::Document(error) => return document(error),
        MaterialError::Model { .. } => "brdf export writes it with --to json",
        _ => return error.to_string(),
    };
    with_hint(error, hint)
}

/// Why the fits to export cannot be chosen.
pub(super) fn selection(error: &SelectionError) -> String {
    let hint = match error {
        SelectionError::NoColour { .. } => {
            "--rgb RED,GREEN,BLUE chooses the wavelengths, --wavelength UM one of them for grey"
        }
        SelectionError::SeveralFiles { .. } => "--file chooses one",
        SelectionError::SeveralWavelengths { .. } => "--wavelength chooses one",
        _ => return error.to_string(),
    };
    with_hint(error, hint)
}

/// Why a material cannot be exported.
pub(super) fn export(error: &ExportError) -> String {
    let hint = match error {
        ExportError::Selection(error) => return selection(error),
        ExportError::Tolerance {
            reachable: Some(tolerance),
            ..
        } => format!("--tolerance {tolerance:.1e} or more"),
        ExportError::Bins { .. } => "--tolerance".to_owned(),
        ExportError::Name(_) => "--name".to_owned(),
        _ => return error.to_string(),
    };
    with_hint(error, &hint)
}

/// What the user of a fit should know about it.
pub(super) fn warning(warning: &Warning) -> String {
    match warning {
        Warning::ThetaReversed { .. } => with_hint(
            warning,
            "--theta-positive forward, or --phi-zero forward, reads it so",
        ),
        Warning::Reading(hint) => match hint {
            Hint::Nanometres { .. } => {
                with_hint(warning, "--columns wavelength_um=wavelength_nm reads it so")
            }
            Hint::TooBright { .. } => with_hint(
                warning,
                "for example --declare quantity=reflectance_factor_percent",
            ),
            Hint::PeaksTowardsSource { .. } => {
                with_hint(warning, "--theta-positive forward reads it so")
            }
            Hint::AllNegative => with_hint(warning, "--declare quantity=log10_brdf"),
            Hint::DetectorShadow { within_deg, .. } => {
                let degrees = within_deg.ceil() + 1.0;
                with_hint(warning, &format!("--mask-source {degrees} leaves them out"))
            }
            _ => warning.to_string(),
        },
        _ => warning.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{FixedError, Model, Parameter};

    #[test]
    fn a_hint_follows_a_message_that_does_not_name_the_option() {
        let hint = "--tolerance 0.1 or more";
        assert_eq!(with_hint("too large", hint), format!("too large ({hint})"));
        let named = "too large: expected --tolerance 0.2";
        assert_eq!(with_hint(named, hint), named);
    }

    #[test]
    fn errors_in_the_options_name_the_option() {
        let (parameter, model) = (Parameter::P, Model::Three);
        for (error, option) in [
            (FitError::NoRefractiveIndex(Some(0.63)), "--n 1.5"),
            (FitError::EnergyLimit(95.0), "--energy-conserving"),
            (FitError::Objective(ObjectiveError::NoSigma), "--weights"),
            (FitError::NoStage, "--stage1"),
            (FixedError::NotFree { parameter, model }.into(), "--fix"),
            (FitError::FixedAboveEnergy(80.0), "--energy-conserving"),
        ] {
            let explained = fit(&error);
            assert!(
                error.is_usage() && explained.contains(option),
                "{explained}"
            );
        }
        let of_data = FitError::SeveralWavelengths(2);
        assert_eq!(fit(&of_data), of_data.to_string());
    }

    #[test]
    fn a_warning_about_the_sides_names_the_option() {
        let text = warning(&Warning::ThetaReversed { e_percent: 2.0 });
        assert!(text.contains("--theta-positive forward"), "{text}");
    }
}
