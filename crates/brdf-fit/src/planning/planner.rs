//! The next readings of a scan.

use brdf_core::ModelParameters;
use brdf_core::scene::{Azimuth, Domain};

use super::advice::{Advice, WORTHWHILE};
use super::choice::{Choice, Chooser};
use super::criterion::Criterion;
use super::error::PlanError;
use super::errors::ErrorModel;
use super::instrument::Instrument;
use super::prior::{MaterialClass, Prior, parameters};
use super::scene_points::{DIRECTIONS, directions, thinned};
use super::setting::{Setting, Site};
use super::state::{Reading, State};
use crate::fit::FitError;
use crate::objective::{ObjectiveError, SIZES};
use crate::scan::{Measurement, Measurements};

/// More candidates are thinned evenly: a plan over 2000 takes about a second.
const MOST_CANDIDATES: usize = 2000;

/// Settings that differ by less are one, in radians: 0.5 deg.
const SAME_SETTING: f64 = 0.008_727;

/// The largest angle of a scene, in radians: 89.9 deg.
const LARGEST_ANGLE: f64 = 1.569;

/// What is to be known, and what can be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanOptions {
    /// The kind of surface, from which the likely parameters are taken.
    pub material: MaterialClass,
    /// The directions of the scene.
    pub scene: Domain,
    /// The root mean square error of f_r over the scene that is allowed, relative to f_r.
    pub tolerance: f64,
    /// The goniometer.
    pub instrument: Instrument,
    /// The largest number of readings that are proposed.
    pub most: usize,
    /// The errors that are reckoned with.
    pub errors: ErrorModel,
}

/// A surface of any kind, over all directions up to 85 deg within 10 %, and at most 12 readings.
impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            material: MaterialClass::Unknown,
            scene: Domain::default(),
            tolerance: 0.1,
            instrument: Instrument::default(),
            most: 12,
            errors: ErrorModel::default(),
        }
    }
}

/// What is predicted for the fit of the readings up to some point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// The root mean square over the scene of the error of ln f_r: a relative error where it is small.
    pub error: f64,
    /// The standard errors of ln k2, ln kD, ln k1 and ln(n - 1).
    pub deviations: [f64; 4],
}

/// A reading to be taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedReading {
    /// Where.
    pub setting: Setting,
    /// The place of the reading in the order in which they were chosen, from 1.
    pub rank: usize,
    /// What is predicted when it has been taken, with all those before it in the list.
    pub prediction: Prediction,
    /// The time from the start until it has been taken, in seconds.
    pub seconds: f64,
}

/// The next readings of a scan, in the order in which they are quick to drive.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementPlan {
    /// The readings to be taken; none where the advice is not to continue.
    pub readings: Vec<PlannedReading>,
    /// What is predicted without them.
    pub now: Prediction,
    /// The smallest error that readings of this instrument would leave: of those listed, or of all its settings.
    pub limit: f64,
    /// The root mean square of ln(predicted/measured) of each reading from the others; `None` with fewer than
    /// six readings.
    pub cross_validated: Option<f64>,
    /// The most probable parameters of `three+n` so far.
    pub parameters: ModelParameters,
    /// Whether further readings are worth their time.
    pub advice: Advice,
    /// The number of readings so far that are above zero, and of those that are not and have no influence.
    pub used: usize,
    /// See `used`.
    pub left_out: usize,
}

/// Plans the next readings of a scan of one wavelength, or of a surface of which nothing was measured.
///
/// The readings are chosen one after the other, each as the one that lowers the logarithm of the mean square error of
/// ln f_r over the scene most for its time (see the [module](crate::planning)), until the tolerance is kept or further
/// ones change little.
/// Readings that are not above zero have no logarithm and no influence; they are counted.
///
/// # Errors
///
/// Several wavelengths, more than 20,000 readings, a quantity that is not positive, or no setting of the instrument
/// within the scene.
pub fn plan_readings(
    scan: Option<&Measurements>,
    options: &PlanOptions,
) -> Result<MeasurementPlan, PlanError> {
    options.check()?;
    let (state, left_out) = options.state(scan)?;
    let candidates = options.candidates(&state)?;
    let scene = directions(&options.scene);
    let field = state.field(&scene, &candidates);
    let criterion = state.criterion(&field);
    let scale = state.scale(&field);
    let now = prediction(&criterion, scale);
    let chosen = choose(&state, &criterion, &candidates, options);
    let predicted = chosen.errors.iter().map(|error| scale * error);
    let all = scale * with_all(&criterion, state.readings.len(), candidates.len());
    let limit = predicted.fold(all.min(now.error), f64::min);
    let after_two = chosen
        .errors
        .get(1)
        .map_or(now.error, |error| scale * error);
    let cross_validated = state.cross_validated();
    let tolerance = options.log_tolerance();
    let advice = Advice::new(
        &state,
        cross_validated,
        now.error,
        after_two,
        limit,
        tolerance,
    );
    let kept = match advice {
        Advice::Continue => options.kept(&chosen.errors, scale),
        Advice::Enough | Advice::Misfit(_) | Advice::Fails { .. } => 0,
    };
    let sites: Vec<usize> = chosen.sites[..kept].to_vec();
    Ok(MeasurementPlan {
        readings: drive(&criterion, &sites, &candidates, &options.instrument, scale),
        now,
        limit,
        cross_validated,
        parameters: parameters(&state.belief.mode),
        advice,
        used: state.readings.len(),
        left_out,
    })
}

/// Chooses readings of a scan one after the other as [`plan_readings`] does, the value of each being known
/// before the next is chosen: the indices of `count` readings, the first of which are those of `pilot`. Times
/// count as they do there: an incidence that was chosen before is no change of it.
///
/// The scene is the scan itself: each of its readings counts alike.
///
/// # Errors
///
/// Several wavelengths, or more than 20,000 readings.
pub fn choose_readings(
    scan: &Measurements,
    pilot: &[usize],
    count: usize,
    options: &PlanOptions,
) -> Result<Vec<usize>, PlanError> {
    check_scan(scan)?;
    let all: Vec<(usize, Reading)> = scan
        .readings()
        .iter()
        .enumerate()
        .filter_map(|(i, reading)| Some((i, Reading::new(reading)?)))
        .collect();
    let sites: Vec<Site> = all.iter().map(|(_, reading)| reading.site).collect();
    let scene = thinned(&sites, DIRECTIONS);
    let (mut first, mut rest): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|(i, _)| pilot.contains(i));
    first.sort_by_key(|(i, _)| pilot.iter().position(|p| p == i));
    let (mut chosen, readings): (Vec<usize>, Vec<Reading>) = first.into_iter().unzip();
    let mut state = State::new(Prior::of(options.material), options.errors, readings);
    let mut chooser = Chooser::new(&options.instrument, &state.settings(), &sites);
    while chosen.len() < count {
        let candidates: Vec<Site> = rest.iter().map(|(_, reading)| reading.site).collect();
        let field = state.field(&scene, &candidates);
        let criterion = state.criterion(&field);
        let first = state.readings.len();
        let all = (first..).zip(candidates.iter().map(|site| site.setting));
        let Some(Choice { site, .. }) = chooser.best(&criterion, all) else {
            break;
        };
        let (index, reading) = rest.remove(site - first);
        chosen.push(index);
        chooser.add(reading.site.setting);
        state.add(reading);
    }
    Ok(chosen)
}

/// What is predicted for the fit of a scan of one wavelength over some directions, each of which counts alike.
///
/// # Errors
///
/// Several wavelengths, or a quantity of the options that is not positive.
pub fn predict(
    scan: &Measurements,
    over: &[Setting],
    options: &PlanOptions,
) -> Result<Prediction, PlanError> {
    options.check()?;
    let (state, _) = options.state(Some(scan))?;
    let scene: Vec<Site> = over.iter().copied().filter_map(Site::new).collect();
    let field = state.field(&thinned(&scene, DIRECTIONS), &[]);
    let scale = state.scale(&field);
    Ok(prediction(&state.criterion(&field), scale))
}

impl PlanOptions {
    /// The same options for the directions that a scan spans: incidences and views from 0 to its largest, in the plane
    /// of incidence where all its readings are.
    #[must_use]
    pub fn within(self, scan: &Measurements) -> Self {
        let readings = scan.readings();
        let largest = |of: fn(&Measurement) -> f64| {
            let largest = readings.iter().map(of).fold(0.0, f64::max);
            (0.0, largest.min(LARGEST_ANGLE))
        };
        let azimuth = if readings
            .iter()
            .all(|reading| reading.in_plane_theta().is_some())
        {
            Azimuth::InPlane
        } else {
            Azimuth::Full
        };
        let scene = Domain::new(largest(|r| r.psi), largest(|r| r.theta.abs()), azimuth);
        Self {
            scene: scene.unwrap_or(self.scene),
            ..self
        }
    }

    fn check(&self) -> Result<(), PlanError> {
        let instrument = &self.instrument;
        let positive = [
            ("tolerance", self.tolerance),
            ("step of the incidence angle", instrument.incidence_step),
            ("step of the view angle", instrument.view_step),
            ("step of the azimuth", instrument.azimuth_step),
            ("time of a reading", instrument.reading_seconds),
        ];
        let wrong = positive
            .iter()
            .find(|(_, value)| !(*value > 0.0 && value.is_finite()));
        wrong.map_or(Ok(()), |&(quantity, value)| {
            Err(PlanError::NotPositive { quantity, value })
        })
    }

    /// What the scan so far says, and the number of its readings that have no logarithm.
    fn state(&self, scan: Option<&Measurements>) -> Result<(State, usize), PlanError> {
        let prior = Prior::of(self.material);
        let Some(scan) = scan else {
            return Ok((State::new(prior, self.errors, Vec::new()), 0));
        };
        check_scan(scan)?;
        let readings: Vec<Reading> = scan.readings().iter().filter_map(Reading::new).collect();
        let left_out = scan.readings().len() - readings.len();
        Ok((State::new(prior, self.errors, readings), left_out))
    }

    /// The settings of the instrument in the scene that the scan does not have yet.
    fn candidates(&self, state: &State) -> Result<Vec<Site>, PlanError> {
        let settings = self.instrument.settings(&self.scene);
        let is_new = |site: &Site| {
            !state
                .readings
                .iter()
                .any(|reading| is_same(&reading.site, site))
        };
        let sites: Vec<Site> = settings
            .into_iter()
            .filter_map(Site::new)
            .filter(is_new)
            .collect();
        if sites.is_empty() {
            return Err(PlanError::NoSetting);
        }
        Ok(thinned(&sites, MOST_CANDIDATES))
    }

    /// The tolerance of ln f_r.
    fn log_tolerance(&self) -> f64 {
        self.tolerance.ln_1p()
    }

    /// How many of the readings are worth their time: up to the tolerance where two more change little, and no more
    /// than all the others together change little.
    fn kept(&self, errors: &[f64], scale: f64) -> usize {
        let errors = &errors[..errors.len().min(self.most)];
        let lowest = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let is_last = |i: usize| {
            let is_unchanged = |later: f64| later > (1.0 - WORTHWHILE) * errors[i];
            let after_two = errors.get(i + 2).is_none_or(|later| is_unchanged(*later));
            is_unchanged(lowest) || (after_two && scale * errors[i] <= self.log_tolerance())
        };
        let last = (0..errors.len()).find(|i| is_last(*i));
        last.map_or(errors.len(), |last| last + 1)
    }
}

/// The number of free parameters: this many readings can be equal by chance.
const FREE: usize = 4;

/// The largest number of readings that a plan goes on from.
const MOST_READINGS: usize = 20_000;

/// Checks that a scan is one that readings can be planned for.
pub(super) fn check_scan(scan: &Measurements) -> Result<(), PlanError> {
    let count = scan.readings().len();
    if count > MOST_READINGS {
        let most = MOST_READINGS;
        return Err(PlanError::TooMany { count, most });
    }
    match scan.wavelengths().len() {
        0 | 1 => check_values(scan),
        count => Err(PlanError::Wavelengths(count)),
    }
}

/// Checks the values as the fit does: readings above zero, of a size that the fit accepts, and not all equal.
fn check_values(scan: &Measurements) -> Result<(), PlanError> {
    let readings = scan.readings();
    if !readings.is_empty() && above_zero(scan).is_empty() {
        return Err(PlanError::NoneAboveZero(readings.len()));
    }
    let sizes = readings
        .iter()
        .map(|reading| (reading.brdf * reading.theta.cos()).abs());
    let largest = sizes.fold(0.0, f64::max);
    if largest > 0.0 && !SIZES.contains(&largest) {
        return Err(FitError::from(ObjectiveError::Size(largest)).into());
    }
    let (count, first) = (readings.len(), readings.first().map(|reading| reading.brdf));
    match first.filter(|value| readings.iter().all(|reading| reading.brdf == *value)) {
        Some(value) if count > FREE => Err(FitError::AllEqual { count, value }.into()),
        _ => Ok(()),
    }
}

/// The indices of the readings above zero.
pub(super) fn above_zero(scan: &Measurements) -> Vec<usize> {
    let readings = scan.readings();
    (0..readings.len())
        .filter(|&i| readings[i].brdf > 0.0)
        .collect()
}

/// Whether two sites are one direction pair, that of their mirror image in the plane of incidence included.
fn is_same(a: &Site, b: &Site) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() < SAME_SETTING;
    near(a.setting.psi, b.setting.psi) && near(a.along, b.along) && near(a.across, b.across)
}

/// Sites in the order in which they were chosen, with the error after each.
struct Chosen {
    sites: Vec<usize>,
    errors: Vec<f64>,
}

/// The readings that lower the logarithm of the error most for their time, one after the other.
fn choose(
    state: &State,
    criterion: &Criterion<'_>,
    candidates: &[Site],
    options: &PlanOptions,
) -> Chosen {
    let first = state.readings.len();
    let mut chooser = Chooser::new(&options.instrument, &state.settings(), candidates);
    let mut criterion = criterion.clone();
    let mut chosen = Chosen {
        sites: Vec::new(),
        errors: Vec::new(),
    };
    while chosen.sites.len() < options.most.max(2) {
        let all = (first..).zip(candidates.iter().map(|site| site.setting));
        let free = all.filter(|(site, _)| !chosen.sites.contains(site));
        let Some(Choice { site, error }) = chooser.best(&criterion, free) else {
            break;
        };
        criterion.choose(site);
        chooser.add(candidates[site - first].setting);
        chosen.sites.push(site);
        chosen.errors.push(error);
    }
    chosen
}

/// The error that is left with all candidates.
fn with_all(criterion: &Criterion<'_>, first: usize, count: usize) -> f64 {
    let mut criterion = criterion.clone();
    let sites: Vec<usize> = (first..first + count).collect();
    for site in thinned(&sites, DIRECTIONS) {
        criterion.choose(site);
    }
    criterion.error()
}

fn prediction(criterion: &Criterion<'_>, scale: f64) -> Prediction {
    Prediction {
        error: scale * criterion.error(),
        deviations: (criterion.deviations() * scale).into(),
    }
}

/// The chosen readings in the order of the instrument, with what is predicted after each.
fn drive(
    criterion: &Criterion<'_>,
    sites: &[usize],
    candidates: &[Site],
    instrument: &Instrument,
    scale: f64,
) -> Vec<PlannedReading> {
    let mut criterion = criterion.clone();
    let first = criterion.count() - candidates.len();
    let settings: Vec<Setting> = sites
        .iter()
        .map(|&site| candidates[site - first].setting)
        .collect();
    let order = instrument.order(&settings);
    let driven: Vec<Setting> = order.iter().map(|&i| settings[i]).collect();
    let elapsed = instrument.elapsed(&driven);
    let mut readings = Vec::with_capacity(order.len());
    for (&i, seconds) in order.iter().zip(elapsed) {
        criterion.choose(sites[i]);
        readings.push(PlannedReading {
            setting: settings[i],
            rank: i + 1,
            prediction: prediction(&criterion, scale),
            seconds,
        });
    }
    readings
}

#[cfg(test)]
mod tests {
    use brdf_core::{AnyBrdf, Family};

    use super::*;
    use crate::planning::advice::Region;

    fn options() -> PlanOptions {
        let to = 80_f64.to_radians();
        PlanOptions {
            scene: Domain::new((0.0, to), (0.0, to), Azimuth::InPlane).unwrap(),
            ..PlanOptions::default()
        }
    }

    fn truth(family: Family) -> AnyBrdf {
        let at = ModelParameters {
            k2: 0.1,
            kd: 0.04,
            k1: 0.25,
            n: 1.6,
            p: 1.0,
        };
        AnyBrdf::new(family, &at).unwrap()
    }

    fn measured(value: impl Fn(&Setting) -> f64, settings: &[Setting]) -> Measurements {
        let readings = settings.iter().map(|setting| Measurement {
            wavelength_um: None,
            psi: setting.psi,
            theta: setting.theta,
            phi: setting.phi,
            brdf: value(setting),
            sigma: None,
        });
        Measurements::new("planned", readings.collect()).unwrap()
    }

    fn value(brdf: &AnyBrdf, setting: &Setting) -> f64 {
        brdf.value(&Site::new(*setting).unwrap().geometry)
    }

    /// Measures what is planned, plans again, and so on until the advice is another one.
    fn follow(
        value: impl Fn(&Setting) -> f64,
        options: &PlanOptions,
    ) -> (Vec<Setting>, MeasurementPlan) {
        let mut settings: Vec<Setting> = Vec::new();
        loop {
            let scan = (!settings.is_empty()).then(|| measured(&value, &settings));
            let plan = plan_readings(scan.as_ref(), options).unwrap();
            if plan.readings.is_empty() || settings.len() > 60 {
                return (settings, plan);
            }
            settings.extend(plan.readings.iter().map(|reading| reading.setting));
        }
    }

    #[test]
    fn a_surface_of_the_model_is_known_after_few_readings_and_the_plan_ends() {
        let (brdf, options) = (truth(Family::Paper), options());
        let (settings, plan) = follow(|setting| value(&brdf, setting), &options);
        assert_eq!(plan.advice, Advice::Enough, "{plan:?}");
        assert!((8..=24).contains(&settings.len()), "{}", settings.len());
        let found = AnyBrdf::new(Family::Paper, &plan.parameters).unwrap();
        let squares: Vec<f64> = directions(&options.scene)
            .iter()
            .map(|site| {
                (found.value(&site.geometry) / brdf.value(&site.geometry))
                    .ln()
                    .powi(2)
            })
            .collect();
        let error = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!(error < options.tolerance, "{error}");
    }

    #[test]
    fn a_peak_towards_the_source_is_named_as_what_the_model_misses() {
        let brdf = truth(Family::Paper);
        let with_peak = |setting: &Setting| {
            let apart = setting.from_source() / 12_f64.to_radians();
            value(&brdf, setting) * (1.0 + (-0.5 * apart * apart).exp())
        };
        let options = PlanOptions {
            tolerance: 0.05,
            ..options()
        };
        let every = options.instrument.settings(&options.scene);
        let scan = measured(with_peak, &every);
        let mut coarse = options.clone();
        // Other settings than those of the scan.
        coarse.instrument.view_step = 7_f64.to_radians();
        let plan = plan_readings(Some(&scan), &coarse).unwrap();
        assert_eq!(plan.advice, Advice::Misfit(Region::Retro), "{plan:?}");
        assert!(plan.readings.is_empty());
    }

    /// A mirror with haze: what is planned for it ends with the words that the model fails, and where.
    #[test]
    fn a_surface_that_the_model_does_not_follow_gets_no_plan() {
        let brdf = truth(Family::Paper);
        let with_peak = |setting: &Setting| {
            let apart = setting.from_mirror() / 3_f64.to_radians();
            value(&brdf, setting) * (1.0 + 40.0 * (-0.5 * apart * apart).exp())
        };
        let (settings, plan) = follow(with_peak, &options());
        assert!(settings.len() <= 36, "{}", settings.len());
        let Advice::Fails { misfit, region } = plan.advice else {
            panic!("{plan:?}")
        };
        assert!(misfit > 0.3 && plan.readings.is_empty(), "{plan:?}");
        assert_eq!(region, Region::Mirror);
        let every = options().instrument.settings(&options().scene);
        let scan = measured(with_peak, &every);
        let all = plan_readings(Some(&scan), &PlanOptions::default()).unwrap();
        assert!(
            matches!(
                all.advice,
                Advice::Fails {
                    region: Region::Mirror,
                    ..
                }
            ),
            "{all:?}"
        );
    }

    #[test]
    fn surfaces_of_other_models_are_no_failure() {
        for family in [Family::Smith, Family::Ggx, Family::Beckmann] {
            let brdf = truth(family);
            let (_, plan) = follow(|setting| value(&brdf, setting), &options());
            assert!(
                !matches!(plan.advice, Advice::Fails { .. }),
                "{family:?} {plan:?}"
            );
        }
    }

    #[test]
    fn a_plan_has_several_incidences_and_no_setting_twice() {
        let plan = plan_readings(None, &options()).unwrap();
        assert_eq!(plan.advice, Advice::Continue);
        let readings = &plan.readings;
        for (i, reading) in readings.iter().enumerate() {
            assert!(
                !readings[..i]
                    .iter()
                    .any(|other| other.setting == reading.setting)
            );
            assert!(reading.seconds > 0.0 && reading.prediction.error.is_finite());
        }
        let mut incidences: Vec<f64> = readings.iter().map(|r| r.setting.psi).collect();
        incidences.dedup();
        assert!((2..=8).contains(&incidences.len()), "{incidences:?}");
        let last = readings.last().unwrap();
        assert!(last.prediction.error < 0.3 * plan.now.error);
    }

    /// However long a change of incidence takes: the error of an incidence is common to its readings.
    #[test]
    fn no_plan_has_all_readings_in_one_incidence() {
        for material in MaterialClass::NAMED.map(|(class, _)| class) {
            for change_seconds in [0.0, 120.0, 3600.0] {
                let mut options = PlanOptions {
                    material,
                    ..PlanOptions::default()
                };
                options.instrument.change_seconds = change_seconds;
                let plan = plan_readings(None, &options).unwrap();
                let mut planned: Vec<f64> = plan.readings.iter().map(|r| r.setting.psi).collect();
                planned.dedup();
                assert!(
                    planned.len() >= 3,
                    "{material} {change_seconds} {planned:?}"
                );
            }
        }
    }

    #[test]
    fn readings_that_are_not_above_zero_are_counted_and_measured_settings_are_not_proposed() {
        let (brdf, options) = (truth(Family::Paper), options());
        let first = plan_readings(None, &options).unwrap();
        let settings: Vec<Setting> = first.readings.iter().map(|r| r.setting).collect();
        let scan = measured(
            |s| if s.psi < 0.3 { -1e-4 } else { value(&brdf, s) },
            &settings,
        );
        let plan = plan_readings(Some(&scan), &options).unwrap();
        let negative = scan.readings().iter().filter(|r| r.brdf < 0.0).count();
        assert_eq!(
            (plan.left_out, plan.used),
            (negative, settings.len() - negative)
        );
        for reading in &plan.readings {
            let again = settings.iter().find(|s| **s == reading.setting);
            assert!(again.is_none_or(|s| s.psi < 0.3), "{:?}", reading.setting);
        }
    }

    #[test]
    fn a_pilot_comes_first_and_every_reading_is_chosen_once() {
        let brdf = truth(Family::Ggx);
        let settings = options().instrument.settings(&options().scene);
        let scan = measured(|setting| value(&brdf, setting), &settings[..60]);
        let chosen = choose_readings(&scan, &[7, 3, 20], 12, &options()).unwrap();
        assert_eq!(chosen[..3], [7, 3, 20]);
        assert_eq!(chosen.len(), 12);
        let mut sorted = chosen.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), 12);
        assert_eq!(
            choose_readings(&scan, &[], 100, &options()).unwrap().len(),
            60
        );
    }

    #[test]
    fn readings_that_the_fit_refuses_are_no_scan_so_far() {
        let settings = options().instrument.settings(&options().scene);
        let message = |value: fn(&Setting) -> f64| {
            let scan = measured(value, &settings[..12]);
            plan_readings(Some(&scan), &options())
                .unwrap_err()
                .to_string()
        };
        assert!(message(|_| 0.0).contains("none of 12 readings is above zero"));
        assert!(message(|s| -s.psi).contains("none of 12 readings is above zero"));
        assert!(message(|_| 0.25).contains("all 12 readings are 0.25"));
        assert!(message(|s| 1e40 * (1.0 + s.psi)).contains("expected one between 1e-30 and 1e30"));
        assert!(
            message(|s| 1e-40 * (2.0 + s.theta)).contains("expected one between 1e-30 and 1e30")
        );
    }

    #[test]
    fn what_is_not_positive_and_a_scene_without_settings_are_errors() {
        let mut wrong = options();
        wrong.instrument.view_step = 0.0;
        let message = plan_readings(None, &wrong).unwrap_err().to_string();
        assert!(message.contains("step of the view angle 0"), "{message}");
        let mut none = options();
        none.scene = Domain::new((0.5, 0.5), (0.5, 0.5), Azimuth::InPlane).unwrap();
        none.instrument.from_source = 1.5;
        assert!(matches!(
            plan_readings(None, &none),
            Err(PlanError::NoSetting)
        ));
    }
}
