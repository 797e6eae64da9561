//! A view of the data: the quantity, its axis, the plane and the arrangement of a plot.

use super::palette::Ground;
use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::format::as_degrees;
use crate::scan::Side;

/// The quantity that is plotted, of the readings and of the theory.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// f_r in 1/sr.
    #[default]
    Brdf,
    /// f_r cos theta in 1/sr, the quantity that E compares.
    BrdfCosine,
}

/// The axis of the quantity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// Linear, with zero.
    #[default]
    Linear,
    /// Logarithmic, in decades.
    Logarithmic,
}

/// The arrangement of the incidences.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// All in one plot over the view angle.
    #[default]
    Together,
    /// A plot for each incidence, with the same axes.
    Panels,
    /// The form of the paper: the quantity as radius at the view angle.
    Polar,
}

/// A view of the data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct View {
    /// The quantity that is plotted.
    pub quantity: Quantity,
    /// The axis of the quantity. The polar form is always linear.
    pub scale: Scale,
    /// The arrangement of the incidences.
    pub layout: Layout,
    /// Whether the residuals are plotted below; the polar form has none.
    pub residuals: bool,
    /// The side on which view angles are positive.
    pub theta_positive: Side,
    /// The plane that is plotted: the azimuth phi in radians of its half on the source's side in the
    /// sense of [`Side`]. 0 is the plane of incidence. In JSON it is in degrees, as `azimuth_deg`.
    #[serde(rename = "azimuth_deg", with = "as_degrees")]
    pub azimuth: f64,
    /// The part that is shown; `None` is all. It is not stored, and the polar form shows all.
    #[serde(skip)]
    pub zoom: Option<Zoom>,
    /// The background of a figure. It is not stored.
    #[serde(skip)]
    pub ground: Ground,
}

/// A part of a plot: the ranges of its axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zoom {
    /// The signed view angle in degrees, in the sense of the view.
    pub theta_deg: [f64; 2],
    /// The quantity of the view.
    pub value: [f64; 2],
}

impl Quantity {
    /// The quantity for an f_r in 1/sr at a view zenith angle theta.
    pub fn of(self, brdf: f64, cos_theta: f64) -> f64 {
        match self {
            Self::Brdf => brdf,
            Self::BrdfCosine => brdf * cos_theta,
        }
    }

    /// The short name of the axis, where there is little room.
    pub fn short_name(self) -> &'static str {
        match self {
            Self::Brdf => "f_r / (1/sr)",
            Self::BrdfCosine => "f_r cos theta / (1/sr)",
        }
    }

    /// The name of the axis.
    pub fn axis_name(self) -> &'static str {
        match self {
            Self::Brdf => "BRDF / (1/sr)",
            Self::BrdfCosine => "BRDF cos theta / (1/sr)",
        }
    }
}

impl View {
    /// The view angle in degrees with the sign of the view, for one in radians that is positive on the
    /// side of the azimuth.
    pub fn signed_deg(&self, theta: f64) -> f64 {
        match self.theta_positive {
            Side::Source => theta.to_degrees(),
            Side::Forward => -theta.to_degrees(),
        }
    }

    /// The inverse of [`signed_deg`](Self::signed_deg).
    pub fn theta(&self, shown_deg: f64) -> f64 {
        match self.theta_positive {
            Side::Source => shown_deg.to_radians(),
            Side::Forward => -shown_deg.to_radians(),
        }
    }

    /// Whether the plane is the plane of incidence.
    pub fn in_plane(&self) -> bool {
        angle_between(self.azimuth, 0.0) == 0.0 || angle_between(self.azimuth, PI) == 0.0
    }

    /// The view angle in degrees, with the sign of the view, of the mirror direction of an incidence
    /// angle psi in radians. `None` outside the plane of incidence, except at normal incidence.
    pub fn mirror_deg(&self, psi: f64) -> Option<f64> {
        if angle_between(self.azimuth, 0.0) == 0.0 {
            Some(self.signed_deg(-psi))
        } else if self.in_plane() {
            Some(self.signed_deg(psi))
        } else {
            (psi == 0.0).then_some(0.0)
        }
    }

    /// The name of the axis of the view angle.
    pub fn theta_name(&self) -> String {
        if angle_between(self.azimuth, 0.0) == 0.0 {
            let side = match self.theta_positive {
                Side::Source => "source",
                Side::Forward => "forward",
            };
            return format!("view angle theta / deg ({side} side positive)");
        }
        let towards = match self.theta_positive {
            Side::Source => self.azimuth,
            Side::Forward => self.azimuth + PI,
        };
        let towards = (towards.to_degrees() * 100.0).round() / 100.0;
        format!("view angle theta / deg (positive towards phi = {towards} deg)")
    }
}

/// The angle between two azimuths in radians, from 0 to pi; 0 if they agree within the rounding of
/// degrees.
fn angle_between(a: f64, b: f64) -> f64 {
    let turns = (a - b) / (2.0 * PI);
    let angle = (turns - turns.round()).abs() * 2.0 * PI;
    if angle < 1e-6 { 0.0 } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn view_angles_have_the_sign_of_the_positive_side() {
        let source = View::default();
        let forward = View {
            theta_positive: Side::Forward,
            ..source
        };
        assert_eq!(source.mirror_deg(0.5), Some(-0.5_f64.to_degrees()));
        assert_eq!(forward.mirror_deg(0.5), Some(0.5_f64.to_degrees()));
        for view in [source, forward] {
            assert!((view.theta(view.signed_deg(0.3)) - 0.3).abs() < 1e-15);
        }
        let across = View {
            azimuth: 1.0,
            ..source
        };
        assert_eq!(across.mirror_deg(0.5), None);
        assert!(!across.in_plane() && source.in_plane());
    }

    #[test]
    fn a_view_is_unchanged_by_json() {
        let view = View {
            layout: Layout::Polar,
            azimuth: 90_f64.to_radians(),
            ..View::default()
        };
        let json = serde_json::to_string(&view).unwrap();
        assert!(json.contains("\"azimuth_deg\":90.0"), "{json}");
        assert_eq!(serde_json::from_str::<View>(&json).unwrap(), view);
        assert_eq!(serde_json::from_str::<View>("{}").unwrap(), View::default());
    }
}
