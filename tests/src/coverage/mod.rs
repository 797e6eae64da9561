//! How often the intervals of 95 % hold the parameters that simulated scans are made from, for many
//! samples, arrangements of angles and kinds of noise.

mod simulated;

use std::fmt::Write as _;

use brdf_core::ModelParameters;
use brdf_fit::report::{Depth, Report};
use brdf_fit::{
    AssumedErrors, FitOptions, Knowledge, Loss, Measurement, Measurements, Model, Parameter,
    RefractiveIndex, Weights, fit,
};
use rand::rngs::StdRng;
use rayon::prelude::*;

use crate::generator;
pub use simulated::{Design, Noise, SAMPLES};
use simulated::{Surface, azimuthal, evenly, sample};

/// What is studied: a model and the options of its fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Study {
    /// The paper's model by E.
    Three,
    /// The paper's model with n free.
    ThreeN,
    /// The model with a free exponent and n free.
    PowerN,
    /// The weights of relative errors.
    Relative,
    /// Huber's loss.
    Huber,
    /// Weights 1/sigma^2 by the standard deviations of the independent errors.
    Stated,
}

impl Study {
    /// All studies.
    pub const ALL: [Self; 6] = [
        Self::Three,
        Self::ThreeN,
        Self::PowerN,
        Self::Relative,
        Self::Huber,
        Self::Stated,
    ];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Three => "three",
            Self::ThreeN => "three+n",
            Self::PowerN => "power+n",
            Self::Relative => "three, relative weights",
            Self::Huber => "three, Huber",
            Self::Stated => "three, weights 1/sigma^2",
        }
    }

    fn options(self, truth: &ModelParameters) -> FitOptions {
        let model = match self {
            Self::ThreeN => Model::ThreeN,
            Self::PowerN => Model::PowerN,
            _ => Model::Three,
        };
        let errors = match self {
            Self::Relative => AssumedErrors::Relative,
            Self::Stated => AssumedErrors::Stated,
            _ => AssumedErrors::Constant,
        };
        FitOptions {
            model,
            refractive_index: Some(RefractiveIndex::Same(truth.n)),
            weights: Weights {
                errors,
                ..Weights::default()
            },
            robust: (self == Self::Huber).then_some(Loss::Huber),
            start: Some(*truth),
            stage1: None,
            ..FitOptions::default()
        }
    }
}

/// One cell of a study.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// The model and the options.
    pub study: Study,
    /// A name of [`SAMPLES`].
    pub sample: &'static str,
    /// The angles.
    pub design: Design,
    /// The errors.
    pub noise: Noise,
}

/// How the intervals of a parameter do in one cell.
#[derive(Debug, Clone, Copy)]
pub struct Coverage {
    /// The parameter.
    pub parameter: Parameter,
    /// Of the scans with an interval, the share whose interval of 95 % holds the truth, in percent.
    pub percent: f64,
    /// The same for the interval of 68 %.
    pub percent_68: f64,
    /// The share of scans without an interval, in percent.
    pub without_percent: f64,
    /// The median half width of the intervals over 1.96 times the rms error of the estimates.
    pub width: f64,
}

impl Cell {
    /// Simulates scans and counts the intervals that hold the truth.
    pub fn run(&self, scans: u64) -> Vec<Coverage> {
        let (truth, _) = self.truth();
        let options = self.study.options(&truth);
        let reports: Vec<Report> = self
            .scans(scans)
            .into_par_iter()
            .map(|scan| {
                let (report, error) = Report::new(&scan, &options, Depth::Fit);
                assert_eq!(error, None, "{self:?}");
                report
            })
            .collect();
        let free = options.model.free();
        let of = |&parameter: &Parameter| coverage(parameter, parameter.of(&truth), &reports);
        free.iter().map(of).collect()
    }

    /// How often each test of the noise rejects at its level, in percent: that the errors grow with the
    /// reading, that whole incidences differ, and that neighbours err together.
    ///
    /// # Panics
    ///
    /// A scan cannot be fitted.
    pub fn rejections(&self, count: u64) -> [f64; 3] {
        let scans = self.scans(count);
        let options = self.study.options(&self.truth().0);
        let rejected = |scan: &Measurements| {
            let (report, _) = Report::new(scan, &options, Depth::Tested);
            let tests = report.uncertainty.and_then(|uncertainty| uncertainty.tests);
            let tests = tests.expect("a fit of simulated readings has its tests");
            [
                tests.grows(),
                tests.incidences_differ(),
                tests.neighbours_err_together(),
            ]
        };
        let all: Vec<[bool; 3]> = scans.par_iter().map(rejected).collect();
        std::array::from_fn(|test| {
            let count = all.iter().filter(|rejected| rejected[test]).count();
            100.0 * count as f64 / all.len() as f64
        })
    }

    /// Simulated scans, the same in every run.
    pub fn scans(&self, count: u64) -> Vec<Measurements> {
        let (_, surface) = self.truth();
        let seed = |i: u64| 1_000_003 * i + u64::from(self.noise as u8) + 17 * self.design as u64;
        (0..count)
            .map(|i| self.simulate(&surface, &mut generator(seed(i))))
            .collect()
    }

    /// The parameters that the intervals should hold, and the surface. A surface of another model has
    /// the parameters of its best fit over many incidences.
    fn truth(&self) -> (ModelParameters, Surface) {
        let own = sample(self.sample);
        let surface = Surface::of(self.noise, &own);
        if !self.noise.is_misfit() {
            return (own, surface);
        }
        let angles: Vec<[f64; 3]> = match self.design {
            Design::Azimuthal => {
                let incidences: Vec<f64> = (5..=75).map(f64::from).collect();
                azimuthal(&incidences)
            }
            _ => (5..=75)
                .flat_map(|psi| evenly(f64::from(psi), 28))
                .collect(),
        };
        let mut readings: Vec<Measurement> = angles
            .iter()
            .map(|angles| reading(&surface, angles))
            .collect();
        for reading in &mut readings {
            reading.sigma = Some(0.005 * reading.brdf);
        }
        let ideal = Measurements::new("ideal", readings).expect("readings");
        let best = fit(&ideal, &self.study.options(&own)).expect("a fit");
        (best.at(), surface)
    }

    fn simulate(&self, surface: &Surface, generator: &mut StdRng) -> Measurements {
        let angles = if self.noise.is_misfit() {
            self.design.angles(Some(&mut *generator))
        } else {
            self.design.angles(None)
        };
        let mut readings: Vec<Measurement> = angles
            .iter()
            .map(|angles| reading(surface, angles))
            .collect();
        let cosines: Vec<f64> = readings.iter().map(|reading| reading.theta.cos()).collect();
        let mut values: Vec<f64> = readings
            .iter()
            .zip(&cosines)
            .map(|(reading, cos)| reading.brdf * cos)
            .collect();
        let mut incidence = Vec::with_capacity(readings.len());
        for (i, reading) in readings.iter().enumerate() {
            let same = i > 0 && reading.psi == readings[i - 1].psi;
            let last = incidence.last().copied().unwrap_or(0);
            incidence.push(if same || i == 0 { last } else { last + 1 });
        }
        let errors = self.noise.disturb(&mut values, &incidence, generator);
        for (i, reading) in readings.iter_mut().enumerate() {
            reading.brdf = values[i] / cosines[i];
            reading.sigma = (self.study == Study::Stated).then(|| errors[i] / cosines[i]);
        }
        Measurements::new("simulated", readings).expect("readings")
    }
}

fn reading(surface: &Surface, [psi, theta, phi]: &[f64; 3]) -> Measurement {
    let mut reading = Measurement {
        wavelength_um: None,
        psi: psi.to_radians(),
        theta: theta.to_radians(),
        phi: phi.to_radians(),
        brdf: 0.0,
        sigma: None,
    };
    let geometry = reading.geometry().expect("angles above the horizon");
    reading.brdf = surface.value(&geometry);
    reading
}

fn coverage(parameter: Parameter, truth: f64, reports: &[Report]) -> Coverage {
    let (mut held, mut held_68, mut with) = (0_u32, 0_u32, 0_u32);
    let (mut widths, mut squares) = (Vec::new(), 0.0);
    for report in reports {
        let uncertainty = report.uncertainty.as_ref().expect("a free parameter");
        let estimate = uncertainty.estimate(parameter).expect("a free parameter");
        squares += (estimate.value - truth).powi(2);
        let interval = estimate.interval_95();
        if interval.to.is_none() {
            continue;
        }
        with += 1;
        held += u32::from(interval.contains(truth));
        if let Knowledge::Determined {
            interval_68: narrow,
            ..
        } = estimate.knowledge
        {
            held_68 += u32::from(narrow.contains(truth));
        }
        widths.extend(
            interval
                .from
                .zip(interval.to)
                .map(|(from, to)| 0.5 * (to - from)),
        );
    }
    widths.sort_by(f64::total_cmp);
    let count = reports.len() as f64;
    let median = widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN);
    Coverage {
        parameter,
        percent: 100.0 * f64::from(held) / f64::from(with),
        percent_68: 100.0 * f64::from(held_68) / f64::from(with),
        without_percent: 100.0 - 100.0 * f64::from(with) / count,
        width: median / (1.96 * (squares / count).sqrt()),
    }
}

/// The cells of a study over samples, designs and kinds of noise.
pub fn cells(study: Study, designs: &[Design], noises: &[Noise]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for &noise in noises {
        for &design in designs {
            for sample in SAMPLES {
                // The best k1 of the paper's model to a GGX surface as wide as 002 has no bound.
                if !noise.is_misfit() || sample != "002" {
                    cells.push(Cell {
                        study,
                        sample,
                        design,
                        noise,
                    });
                }
            }
        }
    }
    cells
}

/// The coverage of the cells of one kind of noise, summarised for each parameter.
#[derive(Debug, Clone, Copy)]
pub struct Summary {
    /// The parameter.
    pub parameter: Parameter,
    /// Mean and least coverage over the cells, in percent.
    pub mean: f64,
    /// The least.
    pub least: f64,
    /// The mean coverage of the intervals of 68 %.
    pub mean_68: f64,
    /// The mean share of scans without an interval, in percent.
    pub without: f64,
    /// The median and the largest width over cells.
    pub width: f64,
    /// The largest.
    pub widest: f64,
}

/// Summarises the coverage of some cells for each parameter.
pub fn summarise(cells: &[Vec<Coverage>]) -> Vec<Summary> {
    let parameters = cells[0].len();
    (0..parameters)
        .map(|i| {
            let own: Vec<Coverage> = cells.iter().map(|cell| cell[i]).collect();
            let known: Vec<&Coverage> = own.iter().filter(|c| c.percent.is_finite()).collect();
            let mean = |of: fn(&Coverage) -> f64| {
                known.iter().map(|c| of(c)).sum::<f64>() / known.len() as f64
            };
            let mut widths: Vec<f64> = known.iter().map(|c| c.width).collect();
            widths.sort_by(f64::total_cmp);
            Summary {
                parameter: own[0].parameter,
                mean: mean(|c| c.percent),
                least: known
                    .iter()
                    .map(|c| c.percent)
                    .fold(f64::INFINITY, f64::min),
                mean_68: mean(|c| c.percent_68),
                without: own.iter().map(|c| c.without_percent).sum::<f64>() / own.len() as f64,
                width: widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN),
                widest: widths.last().copied().unwrap_or(f64::NAN),
            }
        })
        .collect()
}

/// The table of a study: a row for each kind of noise, with the mean and the least coverage over the
/// cells, the share of scans without an interval, and the median width.
pub fn table(study: Study, designs: &[Design], noises: &[Noise], scans: u64) -> String {
    let mut text = String::new();
    for &noise in noises {
        let found: Vec<Vec<Coverage>> = cells(study, designs, &[noise])
            .iter()
            .map(|cell| cell.run(scans))
            .collect();
        let summaries = summarise(&found);
        if text.is_empty() {
            let names: Vec<String> = summaries.iter().map(|s| s.parameter.to_string()).collect();
            let _ = writeln!(text, "| noise | {} |", names.join(" | "));
            let _ = writeln!(text, "|---{}|", "|---".repeat(names.len()));
        }
        let columns: Vec<String> = summaries.iter().map(column).collect();
        let _ = writeln!(text, "| {} | {} |", noise.name(), columns.join(" | "));
    }
    text
}

/// `96 [93], none 2, w 1.1`.
fn column(summary: &Summary) -> String {
    let mut text = format!("{:.0} [{:.0}]", summary.mean, summary.least);
    if summary.without >= 0.5 {
        let _ = write!(text, ", none {:.0}", summary.without);
    }
    let _ = write!(text, ", w {:.1}", summary.width);
    text
}

/// The samples and angles for which the tests of the noise are measured.
pub const TESTED: [(&str, Design); 3] = [
    ("Z307", Design::Z307),
    ("003", Design::Four),
    ("002", Design::Eight),
];

/// The table of rejections of the tests of the noise, one row for each kind of noise.
pub fn table_of_tests(scans: u64) -> String {
    let mut table = "| data | errors grow | incidences differ | neighbours err together |\n\
                     |---|---|---|---|\n"
        .to_owned();
    for noise in Noise::ALL {
        let rejections = TESTED.map(|(sample, design)| {
            let cell = Cell {
                study: Study::Three,
                sample,
                design,
                noise,
            };
            cell.rejections(scans)
        });
        let column = |test: usize| {
            rejections
                .map(|found| format!("{:.0}", found[test]))
                .join("/")
        };
        let [grow, differ, together] = [0, 1, 2].map(column);
        let _ = writeln!(
            table,
            "| {} | {grow} | {differ} | {together} |",
            noise.name()
        );
    }
    table
}
