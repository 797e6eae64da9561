//! A plan in files.

use std::io::{self, Write};

use super::text::{percent, rounded_deg, scene};
use crate::planning::{MeasurementPlan, PlanOptions};

/// A scan without values: what is planned is in comments.
pub(super) fn csv(
    plan: &MeasurementPlan,
    options: &PlanOptions,
    writer: &mut dyn Write,
) -> io::Result<()> {
    writeln!(writer, "# readings planned for {}", scene(options))?;
    writeln!(
        writer,
        "# convention: theta positive on the side of the source; fill brdf_per_sr, then: \
         brdf fit FILE --model three+n --weights relative"
    )?;
    if let Some(last) = plan.readings.last() {
        writeln!(
            writer,
            "# predicted rms error of f_r: {}",
            percent(last.prediction.error)
        )?;
    }
    writeln!(writer, "psi_deg,theta_deg,phi_deg,brdf_per_sr")?;
    for reading in &plan.readings {
        let setting = &reading.setting;
        let [psi, theta, phi] = [setting.psi, setting.theta, setting.phi].map(rounded_deg);
        writeln!(writer, "{psi},{theta},{phi},")?;
    }
    Ok(())
}

/// Lines of psi, zenith angle and azimuth.
pub(super) fn list(plan: &MeasurementPlan, writer: &mut dyn Write) -> io::Result<()> {
    for reading in &plan.readings {
        let (zenith, azimuth) = reading.setting.zenith_and_azimuth();
        let [psi, zenith, azimuth] = [reading.setting.psi, zenith, azimuth].map(rounded_deg);
        writeln!(writer, "{psi} {zenith} {azimuth}")?;
    }
    Ok(())
}
