//! The settings of the lobe and of the surface.

use brdf_fit::plot::{Quantity, Scale};
use serde::{Deserialize, Serialize};

use super::subjects::Beside;
use crate::solid::Camera;
use crate::solid::surface::{Light, MOST_STOPS};

/// What the plot shows in three dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Solid {
    /// The lobe of an incidence.
    Lobe,
    /// A ball and a plate under light.
    Surface,
}

/// The largest incidence angle of the lobe and of the light on the plate, in degrees.
pub const LARGEST_PSI_DEG: f64 = 89.0;

/// The smallest incidence angle of the light on the plate, in degrees.
pub const SMALLEST_PLATE_PSI_DEG: f64 = 45.0;

/// The settings of the lobe and of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SolidView {
    /// Which of them is shown in place of the plot of curves.
    pub shown: Option<Solid>,
    /// The quantity of the lobe: f_r cos theta at first, since the lobe of f_r is open at its rim.
    pub quantity: Quantity,
    /// The radius of the lobe.
    pub scale: Scale,
    /// The incidence angle of the lobe in degrees; `None` is one of those that are shown.
    pub psi_deg: Option<f64>,
    /// Where the lobe is looked at from.
    pub camera: Camera,
    /// What is shown beside the active sample. It is not stored.
    #[serde(skip)]
    pub beside: Beside,
    /// The direction of the lamp on the ball: to the right and upwards, in degrees.
    pub lamp_deg: [f64; 2],
    /// The zenith angle of the lamp on the plate, in degrees.
    pub plate_psi_deg: f64,
    /// The share of the sky in the light, in percent; the lamp has the others.
    pub sky_percent: f64,
    /// The exposure in stops; `None` is automatic.
    pub stops: Option<f64>,
}

impl Default for SolidView {
    fn default() -> Self {
        Self {
            shown: None,
            quantity: Quantity::BrdfCosine,
            scale: Scale::Linear,
            psi_deg: None,
            camera: Camera::default(),
            beside: Beside::default(),
            lamp_deg: [35.0, 35.0],
            plate_psi_deg: 75.0,
            sky_percent: 25.0,
            stops: None,
        }
    }
}

impl SolidView {
    /// Whether all numbers are in their ranges.
    pub fn is_valid(&self) -> bool {
        let psi = self.psi_deg.unwrap_or(0.0);
        self.camera.is_valid()
            && (0.0..=LARGEST_PSI_DEG).contains(&psi)
            && self.lamp_deg.iter().all(|angle| angle.is_finite())
            && (SMALLEST_PLATE_PSI_DEG..=LARGEST_PSI_DEG).contains(&self.plate_psi_deg)
            && (0.0..=100.0).contains(&self.sky_percent)
            && (-MOST_STOPS..=MOST_STOPS).contains(&self.stops.unwrap_or(0.0))
    }

    /// The lamp moved by angles in degrees, to the right and upwards as far as it can.
    pub fn with_lamp_moved(self, [right, up]: [f64; 2]) -> Self {
        let [from, above] = self.lamp_deg;
        let right = (from + right + 180.0).rem_euclid(360.0) - 180.0;
        Self {
            lamp_deg: [right, (above + up).clamp(-89.0, 89.0)],
            ..self
        }
    }

    /// The shares of the lamp and of the sky.
    pub fn light(&self) -> Light {
        let sky = (self.sky_percent / 100.0) as f32;
        Light {
            lamp: 1.0 - sky,
            sky,
        }
    }
}
