//! The options of `brdf plan`.

use std::path::PathBuf;

use brdf_core::scene::DomainError;
use clap::{Args, ValueEnum};

use crate::cli::reading::ReadingArguments;
use crate::cli::scene::{SceneArguments, positive};
use crate::planning::{ErrorModel, Instrument, MaterialClass, PlanOptions, SlowAxis};

/// The options that have no effect on a review.
const OF_LISTS: [&str; 10] = [
    "csv",
    "list",
    "tolerance",
    "readings",
    "from_source",
    "largest_incidence",
    "largest_view",
    "step_incidence",
    "step_view",
    "step_azimuth",
];

/// Lists the readings to take next, and says when to stop
///
/// From a kind of surface, or from the readings so far, it lists the readings after which the fit of three+n with
/// relative weights knows f_r best over the directions of a scene, in an order that is quick to drive, with the
/// predicted errors after each. Once the tolerance is kept, or more readings would not help, it says so. The
/// criterion and how well its predictions hold: docs/planning.md.
///
/// Exit status: 0 if it was planned; 2 for incorrect usage, input that cannot be read, or output that
/// cannot be written.
#[derive(Args)]
pub(in crate::cli) struct Arguments {
    /// The readings so far, in any format that brdf fit reads [default: none]; - is standard input
    #[arg(value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,

    /// Look back on FILE instead: which of its readings were needed, and what the scene has that they lack
    #[arg(long, requires = "files", conflicts_with_all = OF_LISTS)]
    pub(super) review: bool,

    /// Of readings at several wavelengths, the wavelength to plan for, in um (the nearest within 1 %)
    #[arg(long, value_name = "UM", value_parser = positive, requires = "files", allow_negative_numbers = true)]
    pub(super) wavelength: Option<f64>,

    /// The kind of surface: paint, anodise, metal or unknown. It matters as long as readings are few
    #[arg(long, value_name = "KIND", default_value_t)]
    material: MaterialClass,

    #[command(flatten)]
    scene: SceneArguments,

    /// The rms error of f_r over the scene that is allowed, relative to f_r
    #[arg(long, value_name = "ERROR", default_value = "0.1", value_parser = positive, allow_negative_numbers = true)]
    tolerance: f64,

    /// The largest number of readings to list
    #[arg(long, value_name = "COUNT", default_value = "12", value_parser = clap::value_parser!(u16).range(1..=200), allow_negative_numbers = true)]
    readings: u16,

    #[command(flatten)]
    pub(super) reading: ReadingArguments,

    #[command(flatten)]
    instrument: InstrumentArguments,

    /// Write the readings so far and the list to this file, as CSV that brdf fit and brdf plan read once brdf_per_sr is
    /// filled; - is standard output
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,

    /// Write the list to this file, as lines of psi, zenith angle and azimuth of the view in degrees (azimuth 0 on
    /// the side of the source, 180 forward); - is standard output
    #[arg(long, value_name = "FILE")]
    pub(super) list: Option<PathBuf>,
}

/// The goniometer.
#[derive(Args)]
#[command(next_help_heading = "Instrument")]
struct InstrumentArguments {
    /// Smallest angle between the source and the detector, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "5", value_parser = angle, allow_negative_numbers = true)]
    from_source: f64,

    /// Largest incidence angle, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "80", value_parser = angle, allow_negative_numbers = true)]
    largest_incidence: f64,

    /// Largest view angle, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "80", value_parser = angle, allow_negative_numbers = true)]
    largest_view: f64,

    /// Step of the incidence angle, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "5", value_parser = step, allow_negative_numbers = true)]
    step_incidence: f64,

    /// Step of the view angle, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "5", value_parser = step, allow_negative_numbers = true)]
    step_view: f64,

    /// Step of the view azimuth, in degrees
    #[arg(long, value_name = "DEGREES", default_value = "15", value_parser = step, allow_negative_numbers = true)]
    step_azimuth: f64,

    /// The axis that is slow to change
    #[arg(long, value_enum, value_name = "AXIS", default_value = "incidence")]
    slow: SlowArgument,

    /// Time of a reading, in seconds
    #[arg(long, value_name = "SECONDS", default_value = "30", value_parser = positive, allow_negative_numbers = true)]
    seconds: f64,

    /// Time of a change of the slow axis, in seconds
    #[arg(long, value_name = "SECONDS", default_value = "120", value_parser = not_negative, allow_negative_numbers = true)]
    seconds_change: f64,
}

/// The value of `--slow`.
#[derive(Clone, Copy, ValueEnum)]
enum SlowArgument {
    /// The incidence angle
    Incidence,
    /// The view azimuth
    Azimuth,
}

impl Arguments {
    /// The options of the library.
    pub(super) fn options(&self) -> Result<PlanOptions, DomainError> {
        Ok(PlanOptions {
            material: self.material,
            scene: self.scene.domain()?,
            tolerance: self.tolerance,
            instrument: self.instrument.instrument(),
            most: usize::from(self.readings),
            errors: ErrorModel::default(),
        })
    }
}

impl InstrumentArguments {
    fn instrument(&self) -> Instrument {
        Instrument {
            from_source: self.from_source.to_radians(),
            largest_incidence: self.largest_incidence.to_radians(),
            largest_view: self.largest_view.to_radians(),
            incidence_step: self.step_incidence.to_radians(),
            view_step: self.step_view.to_radians(),
            azimuth_step: self.step_azimuth.to_radians(),
            slow: match self.slow {
                SlowArgument::Incidence => SlowAxis::Incidence,
                SlowArgument::Azimuth => SlowAxis::Azimuth,
            },
            reading_seconds: self.seconds,
            change_seconds: self.seconds_change,
        }
    }
}

/// A number from 0 on.
fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number >= 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err("expected a number from 0 on".to_owned()),
    }
}

/// An angle from 0 to below 90 deg.
fn angle(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(angle) if (0.0..90.0).contains(&angle) => Ok(angle),
        _ => Err("expected degrees from 0 to below 90".to_owned()),
    }
}

/// A step of 0.5 to 90 deg: with smaller ones, there are more settings than a plan is made of.
fn step(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(step) if (0.5..=90.0).contains(&step) => Ok(step),
        _ => Err("expected degrees from 0.5 to 90".to_owned()),
    }
}
