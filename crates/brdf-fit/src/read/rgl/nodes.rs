//! The readings at the nodes of the values.

use std::f64::consts::{FRAC_PI_2, PI};

use super::tensor::{Tensor, TensorFile};
use super::warp::{Grid, Warp};
use crate::format::counted;
use crate::read::merl::Channel;
use crate::read::number::is_reading;
use crate::scan::Measurement;

/// View zenith angles from here on are at the horizon: within the rounding of pi/2, in radians.
const HORIZON: f64 = FRAC_PI_2 - 1e-9;

/// An isotropic material.
pub(super) struct Material<'a> {
    psis: Vec<f64>,
    facets: Grid,
    area: Grid,
    visible: Vec<Grid>,
    values: &'a Tensor<'a>,
    /// Wavelengths in micrometres.
    wavelengths: Vec<f64>,
    is_rgb: bool,
    has_factor: bool,
}

/// The readings of a material, with the numbers of nodes that are left out.
pub(super) struct Found {
    pub(super) readings: Vec<Measurement>,
    /// How many nodes are read, if not all.
    pub(super) thinned: Option<String>,
    pub(super) beyond: usize,
    pub(super) not_taken: usize,
}

/// A view direction of an incidence, with the factor of its value and the value's place in a slice.
struct Node {
    psi: f64,
    theta: f64,
    phi: f64,
    factor: f64,
    incidence: usize,
    place: usize,
}

impl<'a> Material<'a> {
    /// # Errors
    ///
    /// What is wrong with the file, as the end of a sentence that begins with its name.
    pub(super) fn new(file: &'a TensorFile<'a>) -> Result<Self, String> {
        for name in ["theta_i", "phi_i", "ndf", "sigma", "vndf"] {
            file.expect(name)?;
        }
        let psis = file.get("theta_i", &[None])?.numbers();
        let phis = file.get("phi_i", &[None])?.len();
        if phis > 2 {
            return Err(format!(
                "is a BRDF at {phis} azimuths of the source (phi_i): the material is anisotropic and \
                 cannot be read because the model is isotropic"
            ));
        }
        if let Some(psi) = psis.iter().find(|psi| !(0.0..10.0).contains(*psi)) {
            return Err(format!(
                "has the incidence {psi} in the tensor theta_i: expected radians from 0"
            ));
        }
        let (azimuths, incidences) = (Some(phis), Some(psis.len()));
        let vndf = file.get("vndf", &[azimuths, incidences, None, None])?;
        let visible = (0..psis.len()).map(|slice| Grid::new("vndf", vndf, slice));
        let (values, wavelengths, is_rgb) = values(file, azimuths, incidences)?;
        let jacobian = file.find("jacobian").map(|tensor| tensor.at(0));
        let material = Self {
            facets: Grid::new("ndf", file.get("ndf", &[None, None])?, 0)?,
            area: Grid::new("sigma", file.get("sigma", &[None, None])?, 0)?,
            visible: visible.collect::<Result<_, _>>()?,
            psis,
            values,
            wavelengths,
            is_rgb,
            has_factor: jacobian != Some(0.0),
        };
        for (name, tensor) in [("vndf", vndf), (values_name(is_rgb), values)] {
            check_azimuths(name, tensor, phis)?;
        }
        Ok(material)
    }

    /// The sentence about the colours of the values.
    pub(super) fn colours(&self) -> Option<String> {
        let [red, green, blue] = Channel::ALL.map(Channel::wavelength_um);
        self.is_rgb
            .then(|| format!("red, green and blue are assigned to {red}, {green} and {blue} um"))
    }

    /// The numbers of rows and columns of the nodes of the values.
    fn nodes(&self) -> (usize, usize) {
        let mut sizes = self.values.shape.iter().rev().copied();
        let (columns, rows) = (sizes.next(), sizes.next());
        (rows.unwrap_or(0), columns.unwrap_or(0))
    }

    /// The readings at all nodes, or at every n-th node of the rows and columns where they would be more
    /// than `most`.
    ///
    /// # Errors
    ///
    /// There are too many incidences and wavelengths, an incidence has no visible facets, or a reading
    /// is out of range.
    pub(super) fn readings(&self, most: usize) -> Result<Found, String> {
        let (rows, columns) = self.nodes();
        let slices = self.psis.len().saturating_mul(self.wavelengths.len());
        let count = |step: usize| {
            let nodes = rows.div_ceil(step).saturating_mul(columns.div_ceil(step));
            nodes.saturating_mul(slices)
        };
        let largest = rows.max(columns).max(1);
        if count(largest) > most {
            return Err(format!(
                "has {} and {}: expected {most} pairs of them at most",
                counted(self.psis.len(), "incidence"),
                counted(self.wavelengths.len(), "wavelength")
            ));
        }
        let step = (1..largest)
            .find(|step| count(*step) <= most)
            .unwrap_or(largest);
        let (nodes, beyond) = self.directions(step)?;
        let mut found = Found {
            readings: Vec::new(),
            thinned: (step > 1).then(|| {
                format!(
                    "one node of {step} is read of each row and column of {rows} x {columns}: {} in \
                     place of {}",
                    counted(count(step), "value"),
                    counted(count(1), "value")
                )
            }),
            beyond: beyond.saturating_mul(self.wavelengths.len()),
            not_taken: 0,
        };
        for (channel, &wavelength_um) in self.wavelengths.iter().enumerate() {
            for node in &nodes {
                self.add(node, channel, wavelength_um, &mut found)?;
            }
        }
        Ok(found)
    }

    fn add(
        &self,
        node: &Node,
        channel: usize,
        wavelength_um: f64,
        found: &mut Found,
    ) -> Result<(), String> {
        let (rows, columns) = self.nodes();
        let slice = node.incidence * self.wavelengths.len() + channel;
        let value = self.values.at(slice * rows * columns + node.place);
        if value.is_nan() {
            found.not_taken += 1;
            return Ok(());
        }
        let brdf = value * node.factor;
        if !is_reading(brdf) {
            let (psi, theta) = (node.psi.to_degrees(), node.theta.to_degrees());
            return Err(format!(
                "has values out of range: f_r would be {brdf:e} 1/sr at an incidence of {psi:.3} deg \
                 and a view of {theta:.3} deg"
            ));
        }
        found.readings.push(Measurement {
            wavelength_um: Some(wavelength_um),
            psi: node.psi,
            theta: node.theta,
            phi: node.phi,
            brdf,
            sigma: None,
        });
        Ok(())
    }

    /// The nodes above the surface, and how many others there are.
    fn directions(&self, step: usize) -> Result<(Vec<Node>, usize), String> {
        let (rows, columns) = self.nodes();
        let mut nodes = Vec::new();
        let mut beyond = 0;
        for (incidence, (&psi, visible)) in self.psis.iter().zip(&self.visible).enumerate() {
            let warp = Warp::new(visible.clone()).ok_or_else(|| {
                let degrees = psi.to_degrees();
                format!("has no visible facets at {degrees:.3} deg in the tensor vndf")
            })?;
            for row in (0..rows).step_by(step) {
                for column in (0..columns).step_by(step) {
                    let point = [part(column, columns), part(row, rows)];
                    match self.direction(psi, warp.apply(point)) {
                        Some((theta, phi, factor)) => nodes.push(Node {
                            psi,
                            theta,
                            phi,
                            factor,
                            incidence,
                            place: row * columns + column,
                        }),
                        None => beyond += 1,
                    }
                }
            }
        }
        Ok((nodes, beyond))
    }

    /// Theta and phi of the view by a facet at (u, v), and the factor of the values there; `None` where
    /// the source or the view is at or beyond the horizon.
    fn direction(&self, psi: f64, [u, v]: [f64; 2]) -> Option<(f64, f64, f64)> {
        let (tilt, azimuth) = (u * u * FRAC_PI_2, (2.0 * v - 1.0) * PI);
        let (sin_psi, cos_psi) = psi.sin_cos();
        let (sin_tilt, cos_tilt) = tilt.sin_cos();
        let facet = [sin_tilt * azimuth.cos(), sin_tilt * azimuth.sin(), cos_tilt];
        let cosine = facet[0] * sin_psi + facet[2] * cos_psi;
        let [x, y, z] = facet.map(|component| 2.0 * cosine * component);
        let (x, z) = (x - sin_psi, z - cos_psi);
        let theta = x.hypot(y).atan2(z);
        if !(psi < FRAC_PI_2 && theta < HORIZON && cosine > 0.0) {
            return None;
        }
        let source = [(psi / FRAC_PI_2).sqrt(), 0.5];
        let factor = if self.has_factor {
            self.facets.value([u, v]) / (4.0 * self.area.value(source))
        } else {
            1.0
        };
        Some((theta, y.atan2(x), factor / theta.cos()))
    }
}

/// The position of a node from 0 to 1.
fn part(node: usize, nodes: usize) -> f64 {
    node as f64 / nodes.saturating_sub(1).max(1) as f64
}

fn values_name(is_rgb: bool) -> &'static str {
    if is_rgb { "rgb" } else { "spectra" }
}

/// The tensor of the values, its wavelengths in micrometres, and whether they are colours.
fn values<'a>(
    file: &'a TensorFile<'a>,
    azimuths: Option<usize>,
    incidences: Option<usize>,
) -> Result<(&'a Tensor<'a>, Vec<f64>, bool), String> {
    let is_rgb = file.find("spectra").is_none() && file.find("rgb").is_some();
    let wavelengths = if is_rgb {
        Channel::ALL.map(Channel::wavelength_um).to_vec()
    } else {
        let nanometres = file.get("wavelengths", &[None])?.numbers();
        if let Some(bad) = nanometres.iter().find(|nm| !(**nm > 0.0 && nm.is_finite())) {
            return Err(format!(
                "has the wavelength {bad} nm: expected positive numbers"
            ));
        }
        nanometres.iter().map(|nm| nm / 1000.0).collect()
    };
    let count = Some(wavelengths.len());
    let sizes = [azimuths, incidences, count, None, None];
    Ok((file.get(values_name(is_rgb), &sizes)?, wavelengths, is_rgb))
}

/// # Errors
///
/// The second azimuth of the source has other values than the first.
fn check_azimuths(name: &str, tensor: &Tensor<'_>, azimuths: usize) -> Result<(), String> {
    let half = tensor.len() / 2;
    let differ = |i: usize| tensor.at(i).to_bits() != tensor.at(half + i).to_bits();
    if azimuths == 2 && (0..half).any(differ) {
        return Err(format!(
            "has other values at the second azimuth of the source (phi_i) in the tensor {name}: the \
             material is anisotropic and cannot be read because the model is isotropic"
        ));
    }
    Ok(())
}
