//! The choice of the next reading: by what it brings, and by the time that it takes.

use super::criterion::Criterion;
use super::errors::is_same_incidence;
use super::instrument::Instrument;
use super::setting::{Setting, Site};

/// Times count once the readings have this many incidences.
///
/// A change of incidence takes as long as several readings, so that by their times alone all readings would be at one
/// incidence. The error of an incidence is common to its readings: more of them do not lower it, and with a single
/// incidence nothing tells it from k2 and kD, nor the refractive index from k2. Three incidences give the three
/// parameters that depend on them (k2, kD and n; k1 shows within each) one value each.
const FEWEST_INCIDENCES: usize = 3;

/// A site that was chosen, with the error with it.
pub(super) struct Choice {
    pub(super) site: usize,
    pub(super) error: f64,
}

/// The rule by which one reading after the other is chosen.
pub(super) struct Chooser<'a> {
    instrument: &'a Instrument,
    /// The incidences of the readings so far, and of the list, each once.
    incidences: Vec<f64>,
    /// The incidences that are needed before times count.
    needed: usize,
    /// The list so far, which is driven at once and in its own order.
    list: Vec<Setting>,
}

impl<'a> Chooser<'a> {
    /// With the settings of the readings so far, which are driven no more, and all settings that can be chosen.
    pub(super) fn new(instrument: &'a Instrument, so_far: &[Setting], sites: &[Site]) -> Self {
        let incidences = distinct(so_far.iter().map(|setting| setting.psi));
        let every = so_far.iter().map(|setting| setting.psi);
        let every = distinct(every.chain(sites.iter().map(|site| site.setting.psi)));
        Self {
            instrument,
            incidences,
            needed: every.len().min(FEWEST_INCIDENCES),
            list: Vec::new(),
        }
    }

    /// The site that lowers the logarithm of the error most for its time, of those with these indices; `None`
    /// without any.
    pub(super) fn best(
        &self,
        criterion: &Criterion<'_>,
        sites: impl Iterator<Item = (usize, Setting)>,
    ) -> Option<Choice> {
        let now = criterion.error();
        let rated = sites.map(|(site, setting)| {
            let error = criterion.error_with(site);
            (
                Choice { site, error },
                (now / error).ln() / self.cost(&setting),
            )
        });
        let best = rated.max_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(choice, _)| choice)
    }

    /// What a further setting costs: its time in seconds, or as much as any other before there are enough incidences.
    fn cost(&self, setting: &Setting) -> f64 {
        if self.incidences.len() < self.needed {
            1.0
        } else {
            self.instrument.further_seconds(&self.list, setting)
        }
    }

    /// Adds a setting to the list.
    pub(super) fn add(&mut self, setting: Setting) {
        if !contains(&self.incidences, setting.psi) {
            self.incidences.push(setting.psi);
        }
        self.list.push(setting);
    }
}

fn contains(incidences: &[f64], psi: f64) -> bool {
    incidences.iter().any(|own| is_same_incidence(*own, psi))
}

fn distinct(incidences: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut distinct = Vec::new();
    for psi in incidences {
        if !contains(&distinct, psi) {
            distinct.push(psi);
        }
    }
    distinct
}
