//! Parts of the readings of a scan, as a shorter measurement would give them.

use super::error::TrialError;
use crate::format::in_degrees;
use crate::scan::{Incidence, Measurements};

/// Of each incidence, every `step`-th reading in the order of the file, beginning with its first.
pub(super) fn every_reading(scan: &Measurements, step: usize) -> Measurements {
    let incidences = scan.incidences();
    let kept = |incidence: &Incidence| -> Vec<usize> {
        incidence.readings.iter().copied().step_by(step).collect()
    };
    of_indices(scan, incidences.iter().flat_map(kept).collect())
}

/// Every second incidence, beginning with the smallest.
///
/// # Errors
///
/// There are fewer than two incidences.
pub(super) fn every_second_incidence(scan: &Measurements) -> Result<Measurements, TrialError> {
    let incidences = several_incidences(scan)?;
    let kept = incidences.iter().step_by(2);
    let indices = kept.flat_map(|incidence| incidence.readings.iter().copied());
    Ok(of_indices(scan, indices.collect()))
}

/// All incidences except the largest.
///
/// # Errors
///
/// There are fewer than two incidences.
pub(super) fn without_largest(scan: &Measurements) -> Result<Measurements, TrialError> {
    let incidences = several_incidences(scan)?;
    let kept = &incidences[..incidences.len() - 1];
    let indices = kept
        .iter()
        .flat_map(|incidence| incidence.readings.iter().copied());
    Ok(of_indices(scan, indices.collect()))
}

/// The name of [`without_largest`]: `without 70 deg`.
pub(super) fn without_largest_name(scan: &Measurements) -> String {
    let incidences = scan.incidences();
    let largest = incidences.last().map(|incidence| in_degrees(incidence.psi));
    largest.map_or_else(
        || "without the largest incidence".to_owned(),
        |psi_deg| format!("without {psi_deg} deg"),
    )
}

fn several_incidences(scan: &Measurements) -> Result<Vec<Incidence>, TrialError> {
    let incidences = scan.incidences();
    if incidences.len() < 2 {
        return Err(TrialError::TooFewIncidences(incidences.len()));
    }
    Ok(incidences)
}

/// Some of the readings, in the order of the file.
fn of_indices(scan: &Measurements, mut indices: Vec<usize>) -> Measurements {
    indices.sort_unstable();
    scan.kept(indices)
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;

    use super::*;

    fn sample() -> Measurements {
        crate::scan::synthetic::scan(Parameters::new(0.3, 0.1, 0.2).unwrap(), 1.5)
    }

    fn psi_deg(scan: &Measurements) -> Vec<f64> {
        let incidences = scan.incidences();
        incidences.iter().map(|i| in_degrees(i.psi)).collect()
    }

    #[test]
    fn of_each_incidence_every_second_reading_is_kept() {
        let (all, half) = (sample(), every_reading(&sample(), 2));
        for (all, half) in all.incidences().iter().zip(half.incidences()) {
            assert_eq!(half.psi, all.psi);
            assert_eq!(half.readings.len(), all.readings.len().div_ceil(2));
        }
        assert_eq!(half.readings()[1], all.readings()[2]);
    }

    #[test]
    fn incidences_are_left_out_as_a_whole() {
        let scan = sample();
        let second = every_second_incidence(&scan).unwrap();
        assert_eq!(psi_deg(&second), [0.0, 20.0, 40.0, 60.0]);
        let smaller = without_largest(&scan).unwrap();
        assert_eq!(psi_deg(&smaller).last(), Some(&60.0));
        assert_eq!(without_largest_name(&scan), "without 70 deg");
    }

    #[test]
    fn the_only_incidence_cannot_be_left_out() {
        let scan = sample().up_to(0.0);
        let error = without_largest(&scan).unwrap_err();
        assert_eq!(error, TrialError::TooFewIncidences(1));
        assert_eq!(
            error.to_string(),
            "the scan has 1 incidence: none can be left out"
        );
        assert_eq!(every_second_incidence(&scan).unwrap_err(), error);
        let empty = Measurements::default();
        assert!(without_largest(&empty).is_err());
        assert_eq!(every_reading(&empty, 4).readings(), []);
    }
}
