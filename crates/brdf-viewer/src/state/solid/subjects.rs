//! What the lobe and the surface show: the active sample, and what is beside it.

use std::f64::consts::PI;

use brdf_core::AnyBrdf;

use super::view::LARGEST_PSI_DEG;
use crate::solid::surface::{Channels, channels};
use crate::solid::{Spot, direction};
use crate::state::State;
use crate::state::id::SampleId;
use crate::state::sample::{Sample, Scan};

/// What is shown beside the active sample.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Beside {
    /// The theory that was pinned last, or else the next visible sample.
    #[default]
    Automatic,
    /// Nothing.
    Nothing,
    /// A theory that stays in the plot, by its index.
    Ghost(usize),
    /// Another sample.
    Sample(SampleId),
}

/// A surface that is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The name.
    pub name: String,
    /// The BRDF at the current wavelength.
    pub brdf: AnyBrdf,
    /// The BRDFs of its colours.
    pub channels: Channels,
}

/// Readings of an incidence that was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredIncidence {
    /// The incidence angle in radians.
    pub psi: f64,
    /// The readings: their directions, and the value and its cosine in place of the quantity.
    pub readings: Vec<(Spot, f64)>,
}

impl State {
    /// The choices of what is shown beside the active sample, with their names.
    pub fn choices_beside(&self) -> Vec<(Beside, String)> {
        let mut choices = vec![
            (Beside::Automatic, "beside: automatic".to_owned()),
            (Beside::Nothing, "beside: nothing".to_owned()),
        ];
        let ghosts = self.ghosts.iter().enumerate();
        choices.extend(ghosts.map(|(i, ghost)| (Beside::Ghost(i), ghost.name.clone())));
        let others = self.samples.iter().filter(|s| Some(s.id) != self.active);
        choices.extend(others.map(|sample| (Beside::Sample(sample.id), sample.name.clone())));
        choices
    }

    /// The active sample, if its parameters are in the domain of the model.
    pub fn subject(&self) -> Option<Subject> {
        subject_of(self.active_sample()?)
    }

    /// What is shown beside the active sample.
    pub fn subject_beside(&self) -> Option<Subject> {
        match self.solid.beside {
            Beside::Nothing => None,
            Beside::Ghost(i) => self.ghost_subject(i),
            Beside::Sample(id) => {
                let other = self.sample(id).filter(|_| Some(id) != self.active);
                other.and_then(subject_of)
            }
            Beside::Automatic => {
                let mut ghosts = self.ghosts.iter();
                let pinned = ghosts.rposition(|ghost| Some(ghost.sample) == self.active);
                let pinned = pinned.and_then(|i| self.ghost_subject(i));
                let mut others = self.visible().filter(|s| Some(s.id) != self.active);
                pinned.or_else(|| others.find_map(subject_of))
            }
        }
    }

    fn ghost_subject(&self, index: usize) -> Option<Subject> {
        let ghost = self.ghosts.get(index)?;
        let brdf = ghost.parameters.brdf()?;
        Some(Subject {
            name: ghost.name.clone(),
            brdf,
            channels: Channels {
                brdfs: vec![brdf],
                note: "grey: a theory of one wavelength".to_owned(),
            },
        })
    }

    /// The incidence angle of the lobe in radians: the chosen one, or the middle one of those that are
    /// shown.
    pub fn lobe_psi(&self) -> f64 {
        let chosen = self.solid.psi_deg.map(f64::to_radians);
        let shown = || {
            let psi = self.active_sample()?.scan().visible_psi();
            psi.get(psi.len() / 2).copied()
        };
        let psi = chosen.or_else(shown).unwrap_or(0.25 * PI);
        psi.min(LARGEST_PSI_DEG.to_radians())
    }

    /// The readings of the active scan at the incidence nearest to that of the lobe.
    pub fn lobe_readings(&self) -> Option<MeasuredIncidence> {
        let scan = self.active_sample()?.scan();
        let psi = self.lobe_psi();
        let all = scan.measurements.incidences();
        let distance = |measured: f64| (measured - psi).abs();
        let nearest = all
            .iter()
            .min_by(|a, b| distance(a.psi).total_cmp(&distance(b.psi)))?;
        let readings = nearest.readings.iter().map(|i| reading(scan, *i));
        Some(MeasuredIncidence {
            psi: nearest.psi,
            readings: readings.collect(),
        })
    }
}

/// A reading by its index, with the cosine of its view angle.
fn reading(scan: &Scan, index: usize) -> (Spot, f64) {
    let reading = &scan.measurements.readings()[index];
    let spot = Spot {
        direction: direction(reading.theta, reading.phi),
        value: reading.brdf,
        left_out: scan.left_out().contains(&index),
    };
    (spot, reading.theta.cos())
}

fn subject_of(sample: &Sample) -> Option<Subject> {
    let brdf = |scan: &Scan| Some((scan.wavelength_um(), scan.parameters.brdf()?));
    let current = brdf(sample.scan())?;
    let all: Vec<_> = sample.scans.iter().filter_map(brdf).collect();
    Some(Subject {
        name: sample.name_of(sample.scan()),
        brdf: current.1,
        channels: channels(&all, current),
    })
}
