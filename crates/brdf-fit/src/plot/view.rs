//! How data are looked at: which quantity, on which axis, in which plane, in what arrangement.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::format::as_degrees;
use crate::scan::Side;
use crate::scan::angle_between;

/// What is shown of the readings and of the theory.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// f_r in 1/sr.
    #[default]
    Brdf,
    /// f_r cos theta in 1/sr, which E compares.
    BrdfCosine,
}

/// The axis of the quantity.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// From zero.
    #[default]
    Linear,
    /// In decades.
    Logarithmic,
}

/// How the incidences are arranged.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// All in one plot over the view angle.
    #[default]
    Together,
    /// A plot for each, with the same axes.
    Panels,
    /// The paper's form: the quantity as radius at the view angle.
    Polar,
}

/// How data are looked at.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct View {
    /// What is shown.
    pub quantity: Quantity,
    /// On which axis. The polar form is linear.
    pub scale: Scale,
    /// In what arrangement.
    pub layout: Layout,
    /// Whether the residuals are shown below; not in the polar form.
    pub residuals: bool,
    /// The side that counts positive.
    pub theta_positive: Side,
    /// The plane that is shown: the azimuth phi, in radians, of its half on the source's side in
    /// the sense of [`Side`]; 0 is the plane of incidence (in JSON in degrees, `azimuth_deg`).
    #[serde(rename = "azimuth_deg", with = "as_degrees")]
    pub azimuth: f64,
}

impl Quantity {
    /// The quantity of an f_r in 1/sr at a view zenith angle.
    pub fn of(self, brdf: f64, cos_theta: f64) -> f64 {
        match self {
            Self::Brdf => brdf,
            Self::BrdfCosine => brdf * cos_theta,
        }
    }

    /// The name of its axis where there is little room.
    pub fn short_name(self) -> &'static str {
        match self {
            Self::Brdf => "f_r / (1/sr)",
            Self::BrdfCosine => "f_r cos theta / (1/sr)",
        }
    }

    /// The name of its axis.
    pub fn axis_name(self) -> &'static str {
        match self {
            Self::Brdf => "BRDF / (1/sr)",
            Self::BrdfCosine => "BRDF cos theta / (1/sr)",
        }
    }
}

impl View {
    /// The view angle in degrees as it is shown, of a signed one in radians that is positive on the
    /// side of the azimuth.
    pub fn signed_deg(&self, theta: f64) -> f64 {
        match self.theta_positive {
            Side::Source => theta.to_degrees(),
            Side::Forward => -theta.to_degrees(),
        }
    }

    /// The signed view angle in radians of one in degrees as it is shown.
    pub fn theta(&self, shown_deg: f64) -> f64 {
        match self.theta_positive {
            Side::Source => shown_deg.to_radians(),
            Side::Forward => -shown_deg.to_radians(),
        }
    }

    /// Whether the plane of incidence is shown.
    pub fn in_plane(&self) -> bool {
        angle_between(self.azimuth, 0.0) == 0.0 || angle_between(self.azimuth, PI) == 0.0
    }

    /// The view angle in degrees at which the mirror direction of an incidence is shown; `None` in
    /// another plane than that of incidence, which holds it at normal incidence only.
    pub fn mirror_deg(&self, psi: f64) -> Option<f64> {
        if angle_between(self.azimuth, 0.0) == 0.0 {
            Some(self.signed_deg(-psi))
        } else if self.in_plane() {
            Some(self.signed_deg(psi))
        } else {
            (psi == 0.0).then_some(0.0)
        }
    }

    /// The name of the axis of view angles.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_shown_with_the_sign_of_the_side() {
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
    fn a_view_goes_to_json_and_back() {
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
