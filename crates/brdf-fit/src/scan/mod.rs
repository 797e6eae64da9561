//! The scan: readings of a goniometer, validated and in the convention of the model.

mod convention;
mod refractive_index;
mod subsample;
pub mod synthetic;

pub use convention::{Convention, Format, ReadSettings, Side};
pub use refractive_index::RefractiveIndex;
pub(crate) use refractive_index::WAVELENGTH_TOLERANCE;

use std::cmp::Ordering;
use std::collections::{BTreeMap, HashSet};
use std::f64::consts::{FRAC_PI_2, PI};

use brdf_core::{Geometry, GeometryError};
use serde::{Deserialize, Serialize};

use crate::format::counted;

/// One reading. Angles are in radians and in the convention of the model: positive theta at phi = 0
/// is on the side of the source.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Wavelength in micrometres, if the scan states one.
    pub wavelength_um: Option<f64>,
    /// Incidence zenith angle psi in [0, pi/2).
    pub psi: f64,
    /// View zenith angle theta in (-pi/2, pi/2), signed.
    pub theta: f64,
    /// View azimuth phi, measured from the azimuth of the source.
    pub phi: f64,
    /// Measured f_r in 1/sr. Negative values are noise and are kept.
    pub brdf: f64,
    /// Standard deviation of the reading in 1/sr, if the scan states one.
    pub sigma: Option<f64>,
}

/// Why a reading is invalid.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasurementError {
    /// Angles outside the domain of the model.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A wavelength that is not positive.
    #[error("wavelength {0} um: expected a positive number")]
    Wavelength(f64),
    /// A reading that is not a finite number.
    #[error("BRDF reading {0} 1/sr: expected a finite number")]
    Brdf(f64),
    /// A standard deviation that is not positive.
    #[error("standard deviation {0} 1/sr: expected a positive number")]
    Sigma(f64),
}

impl Measurement {
    /// The reading, after a check of the domain of each value.
    ///
    /// # Errors
    ///
    /// The first value outside its domain.
    pub fn validated(self) -> Result<Self, MeasurementError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if !(0.0..=FRAC_PI_2).contains(&self.psi) {
            return Err(GeometryError::Incidence(self.psi).into());
        }
        if !(-FRAC_PI_2..=FRAC_PI_2).contains(&self.theta) {
            return Err(GeometryError::View(self.theta).into());
        }
        if !self.phi.is_finite() {
            return Err(GeometryError::Azimuth(self.phi).into());
        }
        if let Some(wavelength) = self.wavelength_um.filter(|&w| !positive(w)) {
            return Err(MeasurementError::Wavelength(wavelength));
        }
        if !self.brdf.is_finite() {
            return Err(MeasurementError::Brdf(self.brdf));
        }
        if let Some(sigma) = self.sigma.filter(|&s| !positive(s)) {
            return Err(MeasurementError::Sigma(sigma));
        }
        Ok(self)
    }

    /// The geometry of the reading.
    ///
    /// # Errors
    ///
    /// Angles outside the domain of the model.
    pub fn geometry(&self) -> Result<Geometry, GeometryError> {
        Geometry::new(self.psi, self.theta, self.phi)
    }

    /// The signed view angle in the plane of incidence, in radians; `None` if the azimuth is more than
    /// 1e-6 rad out of the plane.
    pub fn in_plane_theta(&self) -> Option<f64> {
        self.theta_within(0.0, 1e-6)
    }

    /// The signed view angle in the vertical plane through an azimuth, in radians and positive on the
    /// side of the azimuth; `None` if the view is more than 0.05 deg of azimuth out of the plane.
    pub fn theta_in_plane(&self, azimuth: f64) -> Option<f64> {
        self.theta_within(azimuth, SAME_ANGLE)
    }

    fn theta_within(&self, azimuth: f64, tolerance: f64) -> Option<f64> {
        let half_turns = (self.phi - azimuth) / PI;
        let nearest = half_turns.round();
        if (half_turns - nearest).abs() * PI > tolerance && self.theta != 0.0 {
            return None;
        }
        let other_half = nearest.rem_euclid(2.0) == 1.0;
        Some(if other_half { -self.theta } else { self.theta })
    }
}

/// Angles that differ by less than this are equal, in radians: 0.05 deg, the setting accuracy of a
/// goniometer.
const SAME_ANGLE: f64 = 0.05 * PI / 180.0;

/// The readings of one incidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Incidence {
    /// The smallest incidence angle psi of the readings in radians, or the centre of a class of a
    /// table.
    pub psi: f64,
    /// The indices of the readings, in the order of the file.
    pub readings: Vec<usize>,
}

/// The `# key: value` lines of a file, in their order. Keys are in lower case.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Metadata(pub Vec<(String, String)>);

impl Metadata {
    /// The value of a key; the first one if the key is repeated.
    pub fn get(&self, key: &str) -> Option<&str> {
        self.0
            .iter()
            .find(|(name, _)| name == key)
            .map(|(_, value)| value.as_str())
    }
}

/// The readings of a scan, with the metadata of its file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Stored")]
pub struct Measurements {
    /// The source of the readings: the path of a file, or a name that the caller gives.
    pub source: String,
    /// The metadata of the file.
    pub metadata: Metadata,
    /// The refractive index that the file states.
    pub refractive_index: Option<RefractiveIndex>,
    /// The columns of the file that are not used.
    pub ignored_columns: Vec<String>,
    /// The angular convention of the file. The readings here are in that of the model.
    pub convention: Convention,
    /// The format of the file.
    pub format: Format,
    /// What was said about the file when it was read.
    pub read_settings: ReadSettings,
    /// The conversions between the file and the readings, and the values that were left out with
    /// their count, one sentence each.
    pub conversions: Vec<String>,
    /// The width of the classes of incidence angles in radians, for a table whose coordinates are not
    /// those of a goniometer; otherwise `None`.
    pub(crate) incidence_class: Option<f64>,
    pub(crate) readings: Vec<Measurement>,
}

/// [`Measurements`] in a file, before the readings are checked.
#[derive(Deserialize)]
struct Stored {
    source: String,
    metadata: Metadata,
    refractive_index: Option<RefractiveIndex>,
    ignored_columns: Vec<String>,
    convention: Convention,
    format: Format,
    #[serde(default)]
    read_settings: ReadSettings,
    conversions: Vec<String>,
    incidence_class: Option<f64>,
    readings: Vec<Measurement>,
}

impl TryFrom<Stored> for Measurements {
    type Error = MeasurementError;

    fn try_from(stored: Stored) -> Result<Self, MeasurementError> {
        let checked = Self::new(stored.source, stored.readings)?;
        let is_width = |width: &f64| *width > 0.0 && width.is_finite();
        Ok(Self {
            metadata: stored.metadata,
            refractive_index: stored.refractive_index,
            ignored_columns: stored.ignored_columns,
            convention: stored.convention,
            format: stored.format,
            read_settings: stored.read_settings,
            conversions: stored.conversions,
            incidence_class: stored.incidence_class.filter(is_width),
            ..checked
        })
    }
}

impl Measurements {
    /// Measurements from readings that do not come from a file.
    ///
    /// # Errors
    ///
    /// The first reading with a value outside its domain.
    pub fn new(
        source: impl Into<String>,
        readings: Vec<Measurement>,
    ) -> Result<Self, MeasurementError> {
        let readings = readings
            .into_iter()
            .map(Measurement::validated)
            .collect::<Result<_, _>>()?;
        Ok(Self {
            source: source.into(),
            readings,
            ..Self::default()
        })
    }

    /// All readings, in the order of the file.
    pub fn readings(&self) -> &[Measurement] {
        &self.readings
    }

    /// Whether the readings come from a table whose coordinates are not those of a goniometer.
    pub(crate) fn is_table(&self) -> bool {
        self.incidence_class.is_some()
    }

    /// The wavelengths in micrometres, ascending; a single `None` if the scan states none.
    pub fn wavelengths(&self) -> Vec<Option<f64>> {
        let mut all: Vec<Option<f64>> = Vec::new();
        for reading in &self.readings {
            // Most readings repeat the wavelength of the one before.
            if all.last() != Some(&reading.wavelength_um) {
                all.push(reading.wavelength_um);
            }
        }
        all.sort_by(by_value);
        all.dedup();
        all
    }

    /// One scan of one sample whose readings are in several files, such as one for each incidence.
    ///
    /// The metadata are those of the first file. `None` where there is no scan, or where two scans state
    /// different refractive indices.
    pub fn joined(scans: Vec<Self>) -> Option<Self> {
        // A file of several wavelengths is several scans.
        let mut files: Vec<String> = scans.iter().map(|scan| scan.source.clone()).collect();
        files.dedup();
        let mut scans = scans.into_iter();
        let mut joined = scans.next()?;
        let readings = scans.as_slice().iter().map(|scan| scan.readings.len());
        joined.readings.reserve_exact(readings.sum());
        for scan in scans {
            match (&joined.refractive_index, scan.refractive_index) {
                (Some(one), Some(other)) if *one != other => return None,
                (None, other) => joined.refractive_index = other,
                _ => {}
            }
            let new = |known: &[String], all: Vec<String>| -> Vec<String> {
                all.into_iter().filter(|one| !known.contains(one)).collect()
            };
            let (conversions, ignored) = (scan.conversions, scan.ignored_columns);
            joined
                .conversions
                .extend(new(&joined.conversions, conversions));
            joined
                .ignored_columns
                .extend(new(&joined.ignored_columns, ignored));
            joined.readings.extend(scan.readings);
        }
        if let [first, others @ ..] = files.as_slice()
            && !others.is_empty()
        {
            joined.source = format!("{first} and {}", counted(others.len(), "other file"));
        }
        joined.read_settings.joined = files;
        Some(joined)
    }

    /// One scan for each wavelength, in ascending order.
    pub fn by_wavelength(self) -> Vec<Self> {
        let wavelengths = self.wavelengths();
        if wavelengths.len() <= 1 {
            return vec![self];
        }
        let index = |reading: &Measurement| {
            let of = |wavelength: &Option<f64>| by_value(wavelength, &reading.wavelength_um);
            wavelengths.binary_search_by(of).ok()
        };
        let mut counts = vec![0; wavelengths.len()];
        for i in self.readings.iter().filter_map(index) {
            counts[i] += 1;
        }
        // Each scan takes as much memory as its readings need, and no more.
        let scan = |count| Self {
            readings: Vec::with_capacity(count),
            ..self.without_readings()
        };
        let mut split: Vec<Self> = counts.into_iter().map(scan).collect();
        for reading in &self.readings {
            if let Some(i) = index(reading) {
                split[i].readings.push(*reading);
            }
        }
        split
    }

    /// The incidences in ascending order, each with its readings. Angles that differ by less than
    /// 0.05 deg, the setting accuracy of a goniometer, are one incidence. For a table in other
    /// coordinates, an incidence is a class of 5 deg and psi its centre.
    pub fn incidences(&self) -> Vec<Incidence> {
        match self.incidence_class {
            None => self.set_incidences(),
            Some(width) => self.classes(width),
        }
    }

    fn classes(&self, width: f64) -> Vec<Incidence> {
        let mut classes: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
        for (i, reading) in self.readings.iter().enumerate() {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a small number, not negative"
            )]
            let class = (reading.psi / width) as u64;
            classes.entry(class).or_default().push(i);
        }
        let of_class = |(class, readings)| Incidence {
            psi: (class as f64 + 0.5) * width,
            readings,
        };
        classes.into_iter().map(of_class).collect()
    }

    fn set_incidences(&self) -> Vec<Incidence> {
        let mut order: Vec<usize> = (0..self.readings.len()).collect();
        order.sort_by(|&a, &b| self.readings[a].psi.total_cmp(&self.readings[b].psi));
        let psi = |i: usize| self.readings[i].psi;
        let (mut incidences, mut rest) = (Vec::new(), order.as_slice());
        while let Some(&first) = rest.first() {
            let psi_of_first = psi(first);
            let own = rest.partition_point(|&i| psi(i) - psi_of_first < SAME_ANGLE);
            let (readings, others) = rest.split_at(own.max(1));
            rest = others;
            incidences.push(Incidence {
                psi: psi_of_first,
                readings: readings.to_vec(),
            });
        }
        incidences
    }

    /// The azimuths of the vertical planes that contain readings, in radians from 0 to below pi, in
    /// ascending order. Azimuths that differ by less than 0.05 deg are one plane.
    pub fn planes(&self) -> Vec<f64> {
        let oblique = self.readings.iter().filter(|reading| reading.theta != 0.0);
        let mut all: Vec<f64> = oblique
            .map(|reading| reading.phi.rem_euclid(PI))
            // An azimuth just below pi is the plane of incidence after rounding.
            .map(|azimuth| {
                if PI - azimuth < SAME_ANGLE {
                    0.0
                } else {
                    azimuth
                }
            })
            .collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|next, last| *next - *last < SAME_ANGLE);
        if let Some(first) = all.first_mut().filter(|first| **first < SAME_ANGLE) {
            *first = 0.0;
        }
        all
    }

    /// About `limit` readings at most, evenly spaced within each incidence in the order of the file,
    /// and at least one of each incidence; for a table, [`sampled`](Self::sampled).
    #[must_use]
    pub fn thinned(&self, limit: usize) -> Self {
        if self.is_table() {
            return self.sampled(limit);
        }
        let step = self.readings.len().div_ceil(limit.max(1)).max(1);
        let incidences = self.incidences();
        let mut kept: Vec<usize> = incidences
            .iter()
            .flat_map(|incidence| incidence.readings.iter().copied().step_by(step))
            .collect();
        kept.sort_unstable();
        self.kept(kept)
    }

    /// The readings with incidence angles up to `psi` in radians, inclusive.
    #[must_use]
    pub fn up_to(&self, psi: f64) -> Self {
        let incidences = self.incidences();
        let chosen = up_to(&incidences, |incidence| incidence.psi, psi).iter();
        let mut kept: Vec<usize> = chosen.flat_map(|i| i.readings.iter().copied()).collect();
        kept.sort_unstable();
        self.kept(kept)
    }

    /// The measurements without the readings of the given indices, which the user leaves out; the number
    /// is reported in [`conversions`](Self::conversions).
    #[must_use]
    pub fn without(&self, left_out: &[usize]) -> Self {
        let left_out: HashSet<usize> = left_out.iter().copied().collect();
        let mut used = self.kept((0..self.readings.len()).filter(|i| !left_out.contains(i)));
        let count = self.readings.len() - used.readings.len();
        if count > 0 {
            let verb = if count == 1 { "is" } else { "are" };
            let readings = counted(count, "reading");
            used.conversions
                .push(format!("{readings} {verb} left out by choice"));
        }
        used
    }

    /// The readings with the given indices, with the metadata of the file.
    pub(crate) fn kept(&self, indices: impl IntoIterator<Item = usize>) -> Self {
        Self {
            readings: indices.into_iter().map(|i| self.readings[i]).collect(),
            ..self.without_readings()
        }
    }

    fn without_readings(&self) -> Self {
        Self {
            source: self.source.clone(),
            metadata: self.metadata.clone(),
            refractive_index: self.refractive_index.clone(),
            ignored_columns: self.ignored_columns.clone(),
            convention: self.convention,
            format: self.format,
            read_settings: self.read_settings.clone(),
            conversions: self.conversions.clone(),
            incidence_class: self.incidence_class,
            readings: Vec::new(),
        }
    }
}

/// The incidences up to an angle in radians, inclusive, of incidences in ascending order of their angle
/// `psi_of`.
pub(crate) fn up_to<T>(incidences: &[T], psi_of: impl Fn(&T) -> f64, psi: f64) -> &[T] {
    // Rounding of the angle must not exclude the limit itself.
    let limit = psi + 1e-9;
    &incidences[..incidences.partition_point(|incidence| psi_of(incidence) <= limit)]
}

#[expect(
    clippy::ref_option,
    reason = "the signature that sorting and searching need"
)]
fn by_value(a: &Option<f64>, b: &Option<f64>) -> Ordering {
    a.unwrap_or(0.0).total_cmp(&b.unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_json_reads_back_and_is_checked() {
        let mut scan = Measurements::new("test", vec![reading(0.5, 0.3, -0.3, 0.0)]).unwrap();
        scan.refractive_index = Some(RefractiveIndex::Same(1.5));
        let json = serde_json::to_string(&scan).unwrap();
        assert_eq!(serde_json::from_str::<Measurements>(&json).unwrap(), scan);
        let outside = json.replacen("\"psi\":0.3", "\"psi\":1.6", 1);
        let error = serde_json::from_str::<Measurements>(&outside).unwrap_err();
        assert!(error.to_string().contains("psi = 1.6"), "{error}");
    }

    fn reading(wavelength_um: f64, psi: f64, theta: f64, phi: f64) -> Measurement {
        Measurement {
            wavelength_um: Some(wavelength_um),
            psi,
            theta,
            phi,
            brdf: 0.1,
            sigma: None,
        }
    }

    #[test]
    fn wavelengths_are_split_and_sorted() {
        let readings = vec![
            reading(0.85, 0.1, 0.0, 0.0),
            reading(0.63, 0.3, 0.0, 0.0),
            reading(0.85, 0.2, 0.0, 0.0),
        ];
        let scan = Measurements::new("test", readings).unwrap();
        assert_eq!(scan.wavelengths(), [Some(0.63), Some(0.85)]);
        let split = scan.by_wavelength();
        assert_eq!(split[0].readings().len(), 1);
        let angles: Vec<f64> = split[1].incidences().iter().map(|i| i.psi).collect();
        assert_eq!(angles, [0.1, 0.2]);
        for scan in &split {
            assert_eq!(scan.readings.capacity(), scan.readings.len());
        }
    }

    #[test]
    fn the_plane_of_incidence_is_recognised() {
        assert_eq!(reading(1.0, 0.1, 0.4, 0.0).in_plane_theta(), Some(0.4));
        assert_eq!(reading(1.0, 0.1, 0.4, PI).in_plane_theta(), Some(-0.4));
        assert_eq!(
            reading(1.0, 0.1, -0.4, 3.0 * PI).in_plane_theta(),
            Some(0.4)
        );
        assert_eq!(reading(1.0, 0.1, 0.4, 1.0).in_plane_theta(), None);
        assert_eq!(reading(1.0, 0.1, 0.0, 1.0).in_plane_theta(), Some(0.0));
    }

    #[test]
    fn planes_are_those_that_hold_readings() {
        let at = |phi_deg: f64| reading(1.0, 0.1, 0.4, phi_deg.to_radians());
        let all = [0.0, 180.0, 90.0, 270.01, 359.99, 45.0].map(at).to_vec();
        let scan = Measurements::new("test", all).unwrap();
        let degrees: Vec<f64> = scan
            .planes()
            .iter()
            .map(|p| p.to_degrees().round())
            .collect();
        assert_eq!(degrees, [0.0, 45.0, 90.0]);
        assert_eq!(scan.planes()[0], 0.0);
        let across = at(270.0).theta_in_plane(90_f64.to_radians());
        assert_eq!(across, Some(-0.4));
        assert_eq!(at(91.0).theta_in_plane(90_f64.to_radians()), None);
    }

    #[test]
    fn values_outside_the_domain_are_named() {
        let message = |change: &dyn Fn(&mut Measurement)| {
            let mut bad = reading(1.0, 0.1, 0.2, 0.0);
            change(&mut bad);
            Measurements::new("test", vec![bad])
                .unwrap_err()
                .to_string()
        };
        assert!(message(&|m| m.psi = 1.6).contains("psi = 1.6"));
        assert!(message(&|m| m.theta = f64::NAN).contains("theta = NaN"));
        assert!(message(&|m| m.phi = f64::INFINITY).contains("phi = inf"));
        assert!(message(&|m| m.wavelength_um = Some(-1.0)).contains("wavelength -1"));
        assert!(message(&|m| m.brdf = f64::NAN).contains("NaN 1/sr"));
        assert!(message(&|m| m.sigma = Some(0.0)).contains("deviation 0"));
    }
}
