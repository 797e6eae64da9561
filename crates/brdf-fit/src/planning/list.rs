//! A plan as a list for other programs.

use std::fmt::Write as _;

use super::planner::MeasurementPlan;
use super::setting::Setting;
use crate::format::{exact, in_degrees, shortest};
use crate::scan::Measurements;

impl MeasurementPlan {
    /// The readings so far and the planned ones, as CSV in degrees and in the convention of the model: the cells
    /// `brdf_per_sr` of the latter are empty, and read as readings that were not taken until they are filled. Standard
    /// deviations are not written.
    pub fn csv(&self, so_far: Option<&Measurements>) -> String {
        let mut text = String::from(
            "# planned readings are empty; theta is positive on the side of the source, the mirror direction is theta = -psi\n",
        );
        let readings = so_far.map_or(&[][..], Measurements::readings);
        let wavelength = readings.first().and_then(|reading| reading.wavelength_um);
        let first = wavelength.map_or_else(String::new, |um| format!("{},", shortest(um)));
        if wavelength.is_some() {
            text.push_str("wavelength_um,");
        }
        text.push_str("psi_deg,theta_deg,phi_deg,brdf_per_sr\n");
        let taken = readings
            .iter()
            .map(|reading| (Setting::from(reading), exact(reading.brdf)));
        let planned = self
            .readings
            .iter()
            .map(|reading| (reading.setting, String::new()));
        for (setting, value) in taken.chain(planned) {
            let [psi, theta, phi] = [setting.psi, setting.theta, setting.phi].map(rounded_deg);
            let _ = writeln!(text, "{first}{psi},{theta},{phi},{value}");
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

/// A root mean square error of ln f_r as a percentage of f_r: 100 (e^error - 1), with two digits; `>900 %` beyond a factor
/// of ten.
pub fn error_percent(error: f64) -> String {
    if error.is_nan() || error > 10_f64.ln() {
        return ">900 %".to_owned();
    }
    format!("{} %", crate::format::two_digits(100.0 * error.exp_m1()))
}
