//! The surfaces, the angles and the errors of simulated scans.

use std::f64::consts::PI;

use brdf_core::published::PUBLISHED;
use brdf_core::{AnyBrdf, Family, Geometry, ModelParameters};
use rand::rngs::StdRng;

use crate::{in_workspace, normal, one_wavelength, uniform};

/// The parameters that scans are simulated from: three rows of Table 1 of the paper, and a paint.
pub const SAMPLES: [&str; 4] = ["001", "002", "003", "Z307"];

pub(super) fn sample(name: &str) -> ModelParameters {
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
    pub(super) fn angles(self, drawn: Option<&mut StdRng>) -> Vec<[f64; 3]> {
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
pub(super) fn evenly(psi: f64, views: usize) -> Vec<[f64; 3]> {
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

pub(super) fn azimuthal(incidences: &[f64]) -> Vec<[f64; 3]> {
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
    pub(super) fn disturb(
        self,
        values: &mut [f64],
        incidence: &[usize],
        generator: &mut StdRng,
    ) -> Vec<f64> {
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
pub(super) enum Surface {
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
    pub(super) fn of(noise: Noise, own: &ModelParameters) -> Self {
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

    pub(super) fn value(&self, geometry: &Geometry) -> f64 {
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
