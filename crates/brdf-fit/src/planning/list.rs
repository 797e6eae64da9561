//! A plan as a list for other programs.

use std::fmt::Write as _;

use super::planner::MeasurementPlan;
use crate::format::{in_degrees, shortest};

impl MeasurementPlan {
    /// A scan without values, as CSV in degrees and in the convention of the model: the column `brdf_per_sr` is empty,
    /// and read as readings that were not taken until it is filled.
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "# planned readings; theta is positive on the side of the source, the mirror direction is theta = -psi\n\
             psi_deg,theta_deg,phi_deg,brdf_per_sr\n",
        );
        for reading in &self.readings {
            let setting = &reading.setting;
            let [psi, theta, phi] = [setting.psi, setting.theta, setting.phi].map(rounded_deg);
            let _ = writeln!(text, "{psi},{theta},{phi},");
        }
        text
    }

    /// Lines of psi, the zenith angle of the view, and its azimuth in degrees: 0 is the side of the source, 180 the forward
    /// side.
    pub fn list(&self) -> String {
        let mut text = String::new();
        for reading in &self.readings {
            let (zenith, azimuth) = reading.setting.zenith_and_azimuth();
            let angles = [reading.setting.psi, zenith, azimuth].map(rounded_deg);
            let _ = writeln!(text, "{}", angles.join(" "));
        }
        text
    }
}

/// An angle in degrees, without the digits of rounding.
pub fn rounded_deg(radians: f64) -> String {
    // Minus zero is zero.
    let degrees = (1e6 * in_degrees(radians)).round() / 1e6 + 0.0;
    shortest(degrees)
}

/// A root mean square error of ln f_r as a percentage of f_r: 100 (e^error - 1), with two digits.
pub fn error_percent(error: f64) -> String {
    format!("{} %", crate::format::two_digits(100.0 * error.exp_m1()))
}
