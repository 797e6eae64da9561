//! How often the intervals of 95 % hold the parameters that simulated scans are made from, for many
//! samples, arrangements of angles and kinds of noise.

use std::f64::consts::PI;
use std::fmt::Write as _;

use brdf_core::published::PUBLISHED;
use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
use brdf_fit::report::{Depth, Report};
use brdf_fit::{
    AssumedErrors, FitOptions, Knowledge, Loss, Measurement, Measurements, Model, Parameter,
    RefractiveIndex, Weights, fit,
};
use rand::rngs::StdRng;
use rayon::prelude::*;

use crate::{generator, in_workspace, normal, one_wavelength, uniform};

/// The parameters that scans are simulated from: three rows of Table 1 of the paper, and a paint.
pub const SAMPLES: [&str; 4] = ["001", "002", "003", "Z307"];

fn sample(name: &str) -> ModelParameters {
    let row = match name {
        "001" => PUBLISHED[1],
        "002" => PUBLISHED[2],
        "003" => PUBLISHED[5],
        _ => {
            return ModelParameters {
                k2: 0.02286,
                kd: 0.0180,
                k1: 0.191,
                n: 1.5,
                p: 1.0,
            };
        }
    };
    ModelParameters::three(row.parameters, row.n)
}

/// The angles at which a scan is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Design {
    /// Those of the scan of Z307 among the data of the project.
    Z307,
    /// Three incidences of up to 60 views in the plane of incidence.
    Three,
    /// Four of up to 28.
    Four,
    /// Five of up to 35.
    Five,
    /// Eight of up to 25.
    Eight,
    /// Four incidences with 7 views in each of 12 half-planes.
    Azimuthal,
}

impl Design {
    /// The designs in the plane of incidence.
    pub const IN_PLANE: [Self; 5] = [Self::Z307, Self::Three, Self::Four, Self::Five, Self::Eight];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Z307 => "z",
            Self::Three => "3",
            Self::Four => "4",
            Self::Five => "5",
            Self::Eight => "8",
            Self::Azimuthal => "azimuth",
        }
    }

    /// The incidences in degrees, and the number of views of each in the plane of incidence.
    fn in_plane(self) -> (&'static [f64], usize) {
        match self {
            Self::Three => (&[10.0, 40.0, 70.0], 60),
            Self::Five => (&[5.0, 20.0, 35.0, 50.0, 65.0], 35),
            Self::Eight => (&[5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0], 25),
            Self::Z307 | Self::Four | Self::Azimuthal => (&[10.0, 30.0, 50.0, 70.0], 28),
        }
    }

    /// The angles of all readings, psi, theta and phi in degrees. The incidences are those of the
    /// design, or drawn, one from each of as many equal parts of 5 to 75 deg.
    fn angles(self, drawn: Option<&mut StdRng>) -> Vec<[f64; 3]> {
        let (fixed, views) = self.in_plane();
        let count = fixed.len();
        let incidences: Vec<f64> = match drawn {
            None => fixed.to_vec(),
            Some(generator) => {
                let part = 70.0 / count as f64;
                let from = |i: usize| 5.0 + part * i as f64;
                (0..count)
                    .map(|i| uniform(generator, from(i), from(i) + part))
                    .collect()
            }
        };
        match self {
            Self::Z307 => z307(&incidences),
            Self::Azimuthal => azimuthal(&incidences),
            _ => incidences
                .iter()
                .flat_map(|&psi| evenly(psi, views))
                .collect(),
        }
    }
}

/// Views evenly from -80 to 80 deg, less the three that are nearest to the source.
fn evenly(psi: f64, views: usize) -> Vec<[f64; 3]> {
    let theta = |i: usize| -80.0 + 160.0 * i as f64 / (views - 1) as f64;
    let mut all: Vec<f64> = (0..views).map(theta).collect();
    for _ in 0..3 {
        let distance = |i: &usize| (all[*i] - psi).abs();
        let nearest = (0..all.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        all.remove(nearest.expect("a view"));
    }
    all.into_iter().map(|theta| [psi, theta, 0.0]).collect()
}

/// The angles of the measured scan, its incidences above zero replaced in their order.
fn z307(incidences: &[f64]) -> Vec<[f64; 3]> {
    let path = in_workspace("data/measured/z307_on_aluminium.csv");
    let scan = one_wavelength(&path, 0.630_79);
    let measured: Vec<f64> = scan
        .incidences()
        .iter()
        .map(|incidence| incidence.psi.to_degrees())
        .filter(|psi| *psi > 1.0)
        .collect();
    let replaced = |psi: f64| {
        let place = measured.iter().position(|own| (own - psi).abs() < 0.1);
        place.map_or(psi, |i| incidences[i])
    };
    scan.readings()
        .iter()
        .map(|reading| {
            let psi = replaced(reading.psi.to_degrees());
            let theta = reading.in_plane_theta().expect("a view in the plane");
            [psi, theta.to_degrees(), 0.0]
        })
        .collect()
}

fn azimuthal(incidences: &[f64]) -> Vec<[f64; 3]> {
    let mut all = Vec::new();
    for &psi in incidences {
        for phi in (0..360).step_by(30) {
            for theta in (10..=70).step_by(10) {
                all.push([psi, f64::from(theta), f64::from(phi)]);
            }
        }
    }
    all
}

/// The errors of simulated readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// 2 % of the mean of f_r cos theta, the same for all readings.
    Constant,
    /// 1 % of each reading.
    Proportional1,
    /// 5 % of each reading.
    Proportional5,
    /// 0.5 % of the mean, and 2 % of each reading.
    Floor,
    /// 3 % of a reading of the mean, in proportion to its square root.
    Poisson,
    /// 2 % of gain of each incidence, 1 % of each reading.
    Gain,
    /// 1 % of gain, 1 % correlated along the scan, 0.5 % of each reading, and a small floor.
    Real,
    /// 3 %, correlated along the scan by 0.7 from reading to reading.
    Correlated,
    /// 1 % of each reading, and 30 % of one in a hundred.
    Outliers,
    /// 0.5 % of each reading of a surface with the lobe of GGX.
    Lobe,
    /// 0.5 % of each reading of a surface with the lobe and the shadowing of GGX.
    Shadowing,
}

impl Noise {
    /// All kinds.
    pub const ALL: [Self; 11] = [
        Self::Constant,
        Self::Proportional1,
        Self::Proportional5,
        Self::Floor,
        Self::Poisson,
        Self::Gain,
        Self::Real,
        Self::Correlated,
        Self::Outliers,
        Self::Lobe,
        Self::Shadowing,
    ];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Proportional1 => "proportional 1 %",
            Self::Proportional5 => "proportional 5 %",
            Self::Floor => "floor + proportional",
            Self::Poisson => "Poisson-like",
            Self::Gain => "gain 2 % + 1 %",
            Self::Real => "real (gain, AR, floor)",
            Self::Correlated => "AR(1) 0.7",
            Self::Outliers => "outliers 1 %",
            Self::Lobe => "misfit (lobe of GGX)",
            Self::Shadowing => "misfit (GGX with Smith shadowing)",
        }
    }

    /// Whether the surface is not one of the paper's model.
    pub fn is_misfit(self) -> bool {
        matches!(self, Self::Lobe | Self::Shadowing)
    }

    /// The least share of scans, in percent, whose interval has to hold the truth: of each cell, and
    /// in the mean of cells.
    pub fn limits(self) -> (f64, f64) {
        match self {
            Self::Correlated | Self::Real | Self::Outliers => (80.0, 91.0),
            _ => (90.0, 93.0),
        }
    }

    /// Disturbs readings of f_r cos theta, sorted by incidences; returns the standard deviation of the
    /// independent error of each.
    fn disturb(self, values: &mut [f64], incidence: &[usize], generator: &mut StdRng) -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let squares: f64 = values.iter().map(|y| y * y).sum();
        let rms = (squares / values.len() as f64).sqrt();
        let (mut gain, mut along, mut last) = (0.0, 0.0, usize::MAX);
        let mut errors = Vec::with_capacity(values.len());
        for (value, &own) in values.iter_mut().zip(incidence) {
            if own == last {
                along = 0.7 * along + (1.0 - 0.49_f64).sqrt() * normal(generator);
            } else {
                (gain, along, last) = (normal(generator), normal(generator), own);
            }
            let z = normal(generator);
            let y = *value;
            let (common, independent) = match self {
                Self::Constant => (0.0, 0.02 * mean),
                Self::Proportional1 => (0.0, 0.01 * y),
                Self::Proportional5 => (0.0, 0.05 * y),
                Self::Floor => (0.0, (0.005 * mean).hypot(0.02 * y)),
                Self::Poisson => (0.0, 0.03 * (y * mean).sqrt()),
                Self::Gain => (0.02 * gain, 0.01 * y),
                Self::Real => (0.01 * gain + 0.01 * along, (0.005 * y).hypot(0.001 * rms)),
                Self::Correlated => (0.03 * along, 0.0),
                Self::Outliers => {
                    let outlier = uniform(generator, 0.0, 1.0) < 0.01;
                    let own = if outlier {
                        0.3 * normal(generator)
                    } else {
                        0.0
                    };
                    (own, 0.01 * y)
                }
                Self::Lobe | Self::Shadowing => (0.0, 0.005 * y),
            };
            *value = y * (1.0 + common) + independent * z;
            // A standard deviation is never zero: a scan that is only correlated states 0.2 % of a reading.
            errors.push(independent.max(0.002 * y));
        }
        errors
    }
}

/// A surface that readings are simulated from.
enum Surface {
    Model(AnyBrdf),
    /// The paper's model without its diffuse part, the lobe of which is replaced by that of GGX, of the
    /// same width at half its height.
    Lobe {
        specular: AnyBrdf,
        kd: f64,
        k1: f64,
    },
}

/// The width of GGX over k1 at which the two lobes have the same half height.
const SAME_HALF_HEIGHT: f64 = 1.554;

impl Surface {
    fn of(noise: Noise, own: &ModelParameters) -> Self {
        let model =
            |family, at: &ModelParameters| AnyBrdf::new(family, at).expect("valid parameters");
        let alpha = SAME_HALF_HEIGHT * own.k1;
        match noise {
            Noise::Shadowing => {
                Self::Model(model(Family::Ggx, &ModelParameters { k1: alpha, ..*own }))
            }
            Noise::Lobe => Self::Lobe {
                specular: model(Family::Paper, &ModelParameters { kd: 0.0, ..*own }),
                kd: own.kd,
                k1: own.k1,
            },
            _ => Self::Model(model(Family::Paper, own)),
        }
    }

    fn value(&self, geometry: &Geometry) -> f64 {
        match self {
            Self::Model(brdf) => brdf.value(geometry),
            Self::Lobe { specular, kd, k1 } => {
                let (t, sec) = (geometry.tan2_alpha(), geometry.sec_alpha());
                let paper = sec / (1.0 + t / (k1 * k1));
                let ggx = (sec * sec / (1.0 + t / (SAME_HALF_HEIGHT * k1).powi(2))).powi(2);
                kd / PI + specular.value(geometry) * ggx / paper
            }
        }
    }
}

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
