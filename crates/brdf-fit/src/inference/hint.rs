//! Hints that a file may mean other quantities, units or angles than those it was read with: from the
//! numbers alone.

use std::f64::consts::PI;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::format::counted;
use crate::scan::{Measurement, Measurements};

/// Above this wavelength in um no table of paints is measured, and nanometres are likely.
const LONGEST_UM: f64 = 100.0;

/// A quarter of the readings of a surface that reflects no more than it receives are below this many
/// times 1/pi, unless nearly all are in the specular lobe.
const BRIGHTEST: f64 = 1.2;

/// Readings of zero are the shadow of the detector within this angle of the source, in degrees.
const SHADOW_DEG: f64 = 12.0;

/// The smallest offset of the specular peaks that is reported, in degrees: the setting accuracy of
/// goniometers is well below.
const LEAST_OFFSET_DEG: f64 = 0.75;

/// A larger offset is no error of setting.
const MOST_OFFSET_DEG: f64 = 8.0;

/// A specular peak is at least this many times the median reading of its incidence.
const LEAST_PEAK: f64 = 2.0;

/// Incidence angles in degrees at which the directions of source and mirror are told apart, and the
/// peaks of rough surfaces are hardly displaced towards the horizon.
const INCLINED_DEG: std::ops::RangeInclusive<f64> = 8.0..=50.0;

/// A peak within this angle of the source stands at the source, in degrees.
const AT_SOURCE_DEG: f64 = 5.0;

/// What the numbers of a scan suggest about its file. A hint is no proof: the readings are used as they
/// are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "hint", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Hint {
    /// The wavelength is far above those of optical scans.
    Nanometres {
        /// The wavelength as it was read, in um.
        wavelength_um: f64,
    },
    /// The surface is brighter than a perfect diffuser in all directions.
    TooBright {
        /// The lower quartile of the readings over 1/pi.
        factor: f64,
    },
    /// No reading is above zero.
    AllNegative,
    /// Readings of exactly zero beside the direction of the source.
    DetectorShadow {
        /// How many.
        count: usize,
        /// The largest of their angles from the source, in degrees.
        within_deg: f64,
    },
    /// The specular peaks stand beside theta = -psi by one angle at all incidences.
    PeakOffset {
        /// The mean of theta + psi at the peaks, in degrees.
        offset_deg: f64,
    },
    /// The specular peaks stand at theta = +psi: the forward side seems to be positive.
    PeaksTowardsSource {
        /// The number of incidences with such a peak.
        incidences: usize,
    },
    /// The specular peaks stand at theta = 0: view angles are counted from the mirror direction.
    FromMirrorDirection,
    /// The specular peaks stand at twice the incidence angle: view angles are counted from the source.
    FromSource,
}

impl Hint {
    /// The kind of the hint in a word.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Nanometres { .. } => "nanometres?",
            Self::TooBright { .. } => "too-bright?",
            Self::AllNegative => "all-negative?",
            Self::DetectorShadow { .. } => "detector-shadow?",
            Self::PeakOffset { .. } => "peak-offset?",
            Self::PeaksTowardsSource { .. } => "theta-reversed?",
            Self::FromMirrorDirection => "angles-from-mirror-direction?",
            Self::FromSource => "angles-from-source?",
        }
    }
}

impl fmt::Display for Hint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nanometres { wavelength_um } => write!(
                f,
                "the wavelength is {wavelength_um} um: if this is in nm, name the column wavelength_nm"
            ),
            Self::TooBright { factor } => write!(
                f,
                "three quarters of the readings are above {factor:.1} times that of a perfect white \
                 diffuser, 1/pi: if the values are percent, reflectance factors (pi f_r) or signals, \
                 state their quantity"
            ),
            Self::AllNegative => f.write_str(
                "no reading is above zero: if the values are logarithms, state the quantity log10_brdf \
                 or brdf_db",
            ),
            Self::DetectorShadow { count, within_deg } => write!(
                f,
                "{} of exactly zero within {within_deg:.1} deg of the source: if the detector shades the \
                 source there, leave these readings out",
                counted(*count, "reading")
            ),
            Self::PeakOffset { offset_deg } => write!(
                f,
                "the specular peaks stand {:.1} deg from theta = -psi, towards {}: the zero of an angle \
                 may be off",
                offset_deg.abs(),
                if *offset_deg > 0.0 { "the source" } else { "the horizon" }
            ),
            Self::PeaksTowardsSource { incidences } => write!(
                f,
                "at all {incidences} inclined incidences the peak stands at theta = +psi, towards the \
                 source: unless the sample is retroreflective, the file counts the forward side positive"
            ),
            Self::FromMirrorDirection => f.write_str(
                "the specular peaks stand at theta = 0 for all incidences: the view angles seem to be \
                 counted from the mirror direction, expected angles from the normal",
            ),
            Self::FromSource => f.write_str(
                "the specular peaks stand at twice the incidence angle: the view angles seem to be \
                 counted from the source, expected angles from the normal (theta = psi - angle)",
            ),
        }
    }
}

/// All hints about a scan. A table in other coordinates, whose format defines everything, has none.
pub(crate) fn hints(scan: &Measurements) -> Vec<Hint> {
    if scan.is_table() {
        return Vec::new();
    }
    let wavelengths = scan.wavelengths().into_iter().flatten();
    let nanometres = wavelengths
        .filter(|um| *um > LONGEST_UM)
        .map(|wavelength_um| Hint::Nanometres { wavelength_um });
    let mut hints: Vec<Hint> = nanometres.take(1).collect();
    hints.extend(brightness(scan));
    hints.extend(shadow(scan));
    hints
}

fn brightness(scan: &Measurements) -> Option<Hint> {
    let mut values: Vec<f64> = scan.readings().iter().map(|reading| reading.brdf).collect();
    values.sort_by(f64::total_cmp);
    if values.last().is_some_and(|largest| *largest <= 0.0) {
        let any = values.iter().any(|value| *value < 0.0);
        return any.then_some(Hint::AllNegative);
    }
    let factor = PI * values[values.len() / 4];
    (factor > BRIGHTEST).then_some(Hint::TooBright { factor })
}

/// All readings of zero are beside the source, and there are other readings there or elsewhere.
fn shadow(scan: &Measurements) -> Option<Hint> {
    let zero = |reading: &&Measurement| reading.brdf == 0.0;
    let angles: Vec<f64> = scan
        .readings()
        .iter()
        .filter(zero)
        .map(from_source_deg)
        .collect();
    let within_deg = angles.iter().copied().fold(0.0, f64::max);
    let is_shadow =
        angles.len() >= 2 && within_deg <= SHADOW_DEG && angles.len() * 2 < scan.readings().len();
    is_shadow.then_some(Hint::DetectorShadow {
        count: angles.len(),
        within_deg,
    })
}

/// The angle between the directions of source and view, in degrees.
fn from_source_deg(reading: &Measurement) -> f64 {
    let cosine = reading.psi.cos() * reading.theta.cos()
        + reading.psi.sin() * reading.theta.sin() * reading.phi.cos();
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}

/// Another meaning of the view angles that the readings may have.
pub(super) struct Reinterpretation {
    pub(super) hint: Hint,
    /// psi and theta in degrees of the model, from those that were read.
    theta_deg: fn(f64, f64, f64) -> f64,
    offset_deg: f64,
}

impl Reinterpretation {
    /// The scan with this meaning; `None` where a view would not be above the surface.
    pub(super) fn of(&self, scan: &Measurements) -> Option<Measurements> {
        let reading = |reading: &Measurement| {
            let theta = reading.theta_in_plane(0.0)?;
            let (psi_deg, theta_deg) = (reading.psi.to_degrees(), theta.to_degrees());
            let theta_deg = (self.theta_deg)(psi_deg, theta_deg, self.offset_deg);
            (theta_deg.abs() < 90.0).then_some(Measurement {
                theta: theta_deg.to_radians(),
                phi: 0.0,
                ..*reading
            })
        };
        let readings: Vec<Measurement> = scan.readings().iter().filter_map(reading).collect();
        // A few readings may fall below the horizon.
        let most = readings.len() * 10 >= scan.readings().len() * 8;
        Measurements::new("", readings).ok().filter(|_| most)
    }
}

/// The other meanings that the places of the specular peaks suggest. Whether the model describes the
/// readings better with them is for the caller to find out.
pub(super) fn reinterpretations(scan: &Measurements) -> Vec<Reinterpretation> {
    let of = |hint, theta_deg, offset_deg| Reinterpretation {
        hint,
        theta_deg,
        offset_deg,
    };
    let mut all = Vec::new();
    if scan.is_table() {
        return all;
    }
    if let Some(offset_deg) = offset_of_peaks(scan) {
        for part in [0.6, 0.8, 1.0] {
            let offset_deg = part * offset_deg;
            let hint = Hint::PeakOffset { offset_deg };
            all.push(of(hint, |_, theta, offset| theta - offset, offset_deg));
        }
    }
    let one_sided = |sign: f64| {
        let mut readings = scan.readings().iter();
        readings.all(|reading| {
            reading
                .theta_in_plane(0.0)
                .is_some_and(|theta| sign * theta >= 0.0)
        })
    };
    for (sign, theta_deg) in [
        (
            1.0,
            (|psi, theta, _| psi - theta) as fn(f64, f64, f64) -> f64,
        ),
        (-1.0, |psi, theta, _| psi + theta),
    ] {
        if one_sided(sign) {
            all.push(of(Hint::FromSource, theta_deg, 0.0));
        }
    }
    if peaks_in_zero(scan) {
        all.push(of(
            Hint::FromMirrorDirection,
            |psi, theta, _| theta - psi,
            0.0,
        ));
        all.push(of(
            Hint::FromMirrorDirection,
            |psi, theta, _| -theta - psi,
            0.0,
        ));
    }
    all
}

/// The incidence angle and the view angle of the specular peak of each incidence that has one, in degrees.
fn peaks(scan: &Measurements) -> Vec<(f64, f64)> {
    let incidences = scan.incidences();
    let incidences = incidences.iter().filter_map(|incidence| {
        let readings = incidence.readings.iter().map(|&i| &scan.readings()[i]);
        Some((incidence.psi.to_degrees(), peak_deg(readings)?))
    });
    incidences.collect()
}

/// The mean of theta + psi at the peaks of moderate incidence, where the peaks of rough surfaces are hardly
/// displaced; `None` where it is small.
fn offset_of_peaks(scan: &Measurements) -> Option<f64> {
    let peaks = peaks(scan).into_iter();
    let offsets: Vec<f64> = peaks
        .filter(|(psi, _)| (5.0..=40.0).contains(psi))
        .map(|(psi, theta)| theta + psi)
        .collect();
    let mean = offsets.iter().sum::<f64>() / offsets.len() as f64;
    (LEAST_OFFSET_DEG..=MOST_OFFSET_DEG)
        .contains(&mean.abs())
        .then_some(mean)
}

/// Whether the peaks of several moderate incidences stand at theta = 0.
fn peaks_in_zero(scan: &Measurements) -> bool {
    let peaks = peaks(scan);
    let inclined = peaks.iter().filter(|(psi, _)| (15.0..=45.0).contains(psi));
    inclined.clone().count() >= 2 && inclined.into_iter().all(|(_, theta)| theta.abs() <= 3.0)
}

/// That the peaks of all inclined incidences, at least two, stand towards the source.
pub(super) fn peaks_towards_source(scan: &Measurements) -> Option<Hint> {
    if scan.is_table() {
        return None;
    }
    let peaks = peaks(scan);
    let inclined = peaks.iter().filter(|(psi, _)| INCLINED_DEG.contains(psi));
    let incidences = inclined.clone().count();
    let are_all = inclined
        .into_iter()
        .all(|(psi, theta)| (theta - psi).abs() <= AT_SOURCE_DEG);
    (incidences >= 2 && are_all).then_some(Hint::PeaksTowardsSource { incidences })
}

/// The view angle of the specular peak in the plane of incidence, in degrees, from a parabola through the
/// logarithms of the three highest readings; `None` where there is no peak.
fn peak_deg<'a>(readings: impl Iterator<Item = &'a Measurement>) -> Option<f64> {
    let mut curve: Vec<(f64, f64)> = readings
        .filter_map(|reading| Some((reading.in_plane_theta()?.to_degrees(), reading.brdf)))
        .collect();
    curve.sort_by(|a, b| a.0.total_cmp(&b.0));
    let top = (0..curve.len()).max_by(|&i, &j| curve[i].1.total_cmp(&curve[j].1))?;
    let mut values: Vec<f64> = curve.iter().map(|(_, value)| *value).collect();
    values.sort_by(f64::total_cmp);
    let is_peak = curve[top].1 >= LEAST_PEAK * values[values.len() / 2];
    let neighbours = curve.get(top.checked_sub(1)?).zip(curve.get(top + 1));
    let ((before, low), (after, high)) = neighbours.filter(|_| is_peak)?;
    if *low <= 0.0 || *high <= 0.0 {
        return None;
    }
    let (at, peak) = curve[top];
    let (left, right) = (
        (at - before, (peak / low).ln()),
        (after - at, (peak / high).ln()),
    );
    // The vertex of the parabola through the three points.
    let curvature = left.1 * right.0 + right.1 * left.0;
    let shift = (left.1 * right.0.powi(2) - right.1 * left.0.powi(2)) / (2.0 * curvature);
    (curvature > 0.0 && left.0 > 0.0 && right.0 > 0.0).then_some(at + shift)
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;
    use crate::scan::synthetic::scan;

    fn changed(change: impl Fn(&mut Measurement)) -> Vec<Hint> {
        let glossy = scan(Parameters::new(0.3, 0.05, 0.1).unwrap(), 1.5);
        let mut readings = glossy.readings().to_vec();
        readings.iter_mut().for_each(change);
        hints(&Measurements::new("test", readings).unwrap())
    }

    #[test]
    fn a_scan_as_it_should_be_has_no_hint() {
        assert_eq!(changed(|_| {}), []);
    }

    #[test]
    fn each_misreading_has_its_hint() {
        let percent = changed(|reading| reading.brdf *= 100.0 * PI);
        assert!(
            matches!(percent[..], [Hint::TooBright { .. }]),
            "{percent:?}"
        );
        let logarithms = changed(|reading| reading.brdf = -1.0 - reading.brdf);
        assert!(logarithms.contains(&Hint::AllNegative), "{logarithms:?}");
        let nanometres = changed(|reading| reading.wavelength_um = Some(550.0));
        let wavelength_um = 550.0;
        assert_eq!(nanometres, [Hint::Nanometres { wavelength_um }]);
        let shaded = changed(|reading| {
            if from_source_deg(reading) < 6.0 {
                reading.brdf = 0.0;
            }
        });
        assert!(
            matches!(shaded[..], [Hint::DetectorShadow { .. }]),
            "{shaded:?}"
        );
    }

    #[test]
    fn peaks_towards_the_source_suggest_the_other_side() {
        let glossy = scan(Parameters::new(0.3, 0.05, 0.1).unwrap(), 1.5);
        assert_eq!(peaks_towards_source(&glossy), None);
        let mut readings = glossy.readings().to_vec();
        for reading in &mut readings {
            reading.theta = -reading.theta;
        }
        let reversed = Measurements::new("test", readings).unwrap();
        let hint = peaks_towards_source(&reversed);
        assert!(
            matches!(hint, Some(Hint::PeaksTowardsSource { incidences: 2.. })),
            "{hint:?}"
        );
    }

    fn meanings(change: impl Fn(&mut Measurement)) -> Vec<Hint> {
        let glossy = scan(Parameters::new(0.3, 0.05, 0.1).unwrap(), 1.5);
        let mut readings = glossy.readings().to_vec();
        readings.iter_mut().for_each(change);
        let scan = Measurements::new("test", readings).unwrap();
        reinterpretations(&scan)
            .into_iter()
            .map(|other| other.hint)
            .collect()
    }

    #[test]
    fn the_places_of_the_peaks_suggest_other_angles() {
        // Peaks of rough surfaces are displaced, which is no offset: the caller finds that out.
        let as_read = meanings(|_| {});
        assert!(
            as_read
                .iter()
                .all(|hint| matches!(hint, Hint::PeakOffset { .. })),
            "{as_read:?}"
        );
        let shifted = meanings(|reading| reading.theta += 0.03);
        assert!(
            matches!(shifted[..], [Hint::PeakOffset { .. }, ..]),
            "{shifted:?}"
        );
        let from_mirror = meanings(|reading| {
            reading.theta = (reading.theta + reading.psi).clamp(-1.5, 1.5);
        });
        assert!(
            from_mirror.contains(&Hint::FromMirrorDirection),
            "{from_mirror:?}"
        );
        let from_source = meanings(|reading| {
            reading.theta = (reading.psi - reading.theta).clamp(0.0, 1.5);
        });
        assert!(from_source.contains(&Hint::FromSource), "{from_source:?}");
    }
}
