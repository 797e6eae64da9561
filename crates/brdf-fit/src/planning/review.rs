//! Looking back: which readings of a scan were needed, and what it lacks.

use brdf_core::AnyBrdf;
use brdf_core::scene::Domain;

use super::advice::Region;
use super::error::PlanError;
use super::planner::{PlanOptions, above_zero, check_scan, choose_readings};
use super::scene_points::directions;
use super::setting::Setting;
use crate::fit::{FitOptions, fit};
use crate::model::Model;
use crate::objective::weights::{AssumedErrors, Weights};
use crate::scan::{Measurement, Measurements, RefractiveIndex};

/// The fewest readings of a fit of `three+n`.
const FEWEST: usize = 5;

/// No more readings are chosen: a scan that needs more needs all of them.
const MOST: usize = 60;

/// The multiples of the error of the whole scan of which the review tells how many readings reach them.
pub const WITHIN: [f64; 2] = [1.1, 1.3];

/// Angles beyond those of a scan by more than this are a gap, in radians: 10 deg.
const GAP: f64 = 0.174_533;

/// A reading in the order of a plan, and the error of the fit to it and those before it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReviewStep {
    /// The index of the reading in the scan.
    pub reading: usize,
    /// The root mean square of ln(theory/measured) over all readings of the scan above zero; `None` before there
    /// are five readings, and where these cannot be fitted.
    pub error: Option<f64>,
}

/// Directions of the scene that the scan does not have.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Gap {
    /// The scene has incidences beyond the largest of the scan.
    Incidence {
        /// The largest of the scan, in radians.
        scan: f64,
        /// The largest of the scene, in radians.
        scene: f64,
    },
    /// The scene has views beyond the largest of the scan.
    View {
        /// The largest of the scan, in radians.
        scan: f64,
        /// The largest of the scene, in radians.
        scene: f64,
    },
    /// No reading of the scan is in a region of the scene.
    Region(Region),
}

/// What a scan had and lacked.
#[derive(Debug, Clone, PartialEq)]
pub struct Review {
    /// The root mean square of ln(theory/measured) of the fit to all readings.
    pub error: f64,
    /// The readings in the order in which a plan would have chosen them.
    pub steps: Vec<ReviewStep>,
    /// The gaps of the scan in the scene.
    pub gaps: Vec<Gap>,
    /// The number of readings above zero.
    pub used: usize,
    /// The number of readings that are not, which have no influence.
    pub left_out: usize,
}

impl Review {
    /// The number of readings from which on the error stays within a multiple of that of all; `None` where those that
    /// were tried do not reach it.
    pub fn needed(&self, within: f64) -> Option<usize> {
        let is_above = |step: &ReviewStep| step.error.is_none_or(|e| e > within * self.error);
        let after = self.steps.iter().rposition(is_above);
        let count = after.map_or(0, |last| last + 1) + 1;
        (count <= self.steps.len()).then_some(count)
    }
}

/// Reviews a scan of one wavelength: a plan chooses its readings one after the other, and the fit of `three+n` with
/// relative weights to those chosen is compared with that to all of them.
///
/// # Errors
///
/// Several wavelengths, too few readings above zero, or a scan that cannot be fitted.
pub fn review(scan: &Measurements, options: &PlanOptions) -> Result<Review, PlanError> {
    check_scan(scan)?;
    let above = above_zero(scan);
    if above.len() <= FEWEST {
        return Err(PlanError::TooFew {
            count: above.len(),
            least: FEWEST + 1,
        });
    }
    let order = choose_readings(scan, &[], MOST, options)?;
    let error = error_of(scan, &above)?;
    let step = |count: usize| ReviewStep {
        reading: order[count - 1],
        error: (count >= FEWEST)
            .then(|| error_of(scan, &order[..count]).ok())
            .flatten(),
    };
    Ok(Review {
        error,
        steps: (1..=order.len()).map(step).collect(),
        gaps: gaps(scan, &options.scene),
        used: above.len(),
        left_out: scan.readings().len() - above.len(),
    })
}

/// The root mean square of ln(theory/measured) over all readings above zero of a scan, of the fit of `three+n` with
/// relative weights to those of these indices.
///
/// # Errors
///
/// The chosen readings cannot be fitted.
pub fn error_of(scan: &Measurements, chosen: &[usize]) -> Result<f64, PlanError> {
    let options = FitOptions {
        model: Model::ThreeN,
        refractive_index: Some(RefractiveIndex::Same(crate::model::DEFAULT_N)),
        weights: Weights {
            errors: AssumedErrors::Relative,
            ..Weights::default()
        },
        ..FitOptions::default()
    };
    let left_out: Vec<usize> = (0..scan.readings().len())
        .filter(|i| !chosen.contains(i))
        .collect();
    let fitted = fit(&scan.without(&left_out), &options)?;
    let brdf = AnyBrdf::new(fitted.model().family(), &fitted.at());
    let Ok(brdf) = brdf else {
        unreachable!("fitted parameters are in the domain")
    };
    let square = |reading: &Measurement| {
        let geometry = reading.geometry().ok().filter(|_| reading.brdf > 0.0)?;
        Some(
            (brdf.value(&geometry).max(f64::MIN_POSITIVE) / reading.brdf)
                .ln()
                .powi(2),
        )
    };
    let squares: Vec<f64> = scan.readings().iter().filter_map(square).collect();
    Ok((squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

/// The directions of the scene that are not in the scan.
fn gaps(scan: &Measurements, scene: &Domain) -> Vec<Gap> {
    let settings: Vec<Setting> = scan.readings().iter().map(Setting::from).collect();
    let largest = |of: fn(&Setting) -> f64| settings.iter().map(of).fold(0.0, f64::max);
    let (psi, theta) = (largest(|s| s.psi), largest(|s| s.theta.abs()));
    let mut gaps = Vec::new();
    if scene.incidence().1 > psi + GAP {
        let scene = scene.incidence().1;
        gaps.push(Gap::Incidence { scan: psi, scene });
    }
    if scene.view().1 > theta + GAP {
        let scene = scene.view().1;
        gaps.push(Gap::View { scan: theta, scene });
    }
    let directions = directions(scene);
    for region in [Region::Retro, Region::Mirror, Region::OutOfPlane] {
        let in_scene = directions.iter().any(|site| region.contains(&site.setting));
        if in_scene && !settings.iter().any(|setting| region.contains(setting)) {
            gaps.push(Gap::Region(region));
        }
    }
    gaps
}

#[cfg(test)]
mod tests {
    use brdf_core::Parameters;
    use brdf_core::scene::Azimuth;

    use super::*;
    use crate::scan::synthetic;

    #[test]
    fn an_exact_scan_needs_few_of_its_readings_and_lacks_what_it_does_not_have() {
        let truth = Parameters::new(0.3, 0.05, 0.2).unwrap();
        let scan = synthetic::scan(truth, 1.5);
        let options = PlanOptions {
            scene: Domain::new((0.0, 1.4), (0.0, 1.4), Azimuth::Full).unwrap(),
            ..PlanOptions::default()
        };
        let review = review(&scan, &options).unwrap();
        assert!(review.error < 1e-6, "{}", review.error);
        assert!(
            review.gaps.contains(&Gap::Region(Region::OutOfPlane)),
            "{:?}",
            review.gaps
        );
        let last = review.steps.last().unwrap();
        assert!(last.error.unwrap() < 1e-4);
    }
}
