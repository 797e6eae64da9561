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

/// The same with as many digits, up to six more, as show on which side of a tolerance it is.
pub fn error_percent_beside(error: f64, tolerance: f64) -> String {
    let short = error_percent(error);
    let Some(rounded) = short
        .strip_suffix(" %")
        .filter(|text| !text.starts_with('>'))
    else {
        return short;
    };
    let [own, limit] = [error, tolerance].map(|error| 100.0 * error.exp_m1());
    let is_true = |text: &str| {
        let shown: Option<f64> = text.parse().ok();
        shown.is_some_and(|shown| shown.total_cmp(&limit) == own.total_cmp(&limit))
    };
    if is_true(rounded) {
        return short;
    }
    let decimals = rounded
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let mut longer = (decimals + 1..=decimals + 6).map(|decimals| format!("{own:.decimals$}"));
    longer
        .find(|text| is_true(text))
        .map_or(short, |text| format!("{text} %"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_beside_its_tolerance_is_not_rounded_to_it() {
        let logs = |percent: f64| (0.01 * percent).ln_1p();
        let beside = |error, tolerance| error_percent_beside(logs(error), logs(tolerance));
        assert_eq!(beside(10.4, 10.0), "10.4 %");
        assert_eq!(beside(9.996, 10.0), "9.996 %");
        assert_eq!(beside(10.0, 10.0), "10 %");
        assert_eq!(beside(12.3, 10.0), "12 %");
        assert_eq!(beside(5.04, 10.0), "5.0 %");
        assert_eq!(beside(9.04, 9.5), "9.0 %");
        assert_eq!(beside(9.496, 9.5), "9.496 %");
        // A tolerance that two digits would not show.
        assert_eq!(beside(10.4, 10.2), "10.4 %");
        assert_eq!(beside(2000.0, 10.0), ">900 %");
    }
}
