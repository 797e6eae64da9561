//! What figures and meshes of the lobe and of the surface contain.

use brdf_fit::format::two_digits;
use brdf_fit::plot::{Quantity, Scale};

use super::view::SolidView;
use crate::job::LobeDrawing;
use crate::solid::LobeScene;
use crate::solid::surface::Composition;
use crate::state::State;
use crate::state::sample::Scan;

impl State {
    /// The lobe that is shown.
    pub(in crate::state) fn drawn_lobe(&self) -> Option<LobeDrawing> {
        let scene = self.derived_solid.lobe()?;
        let sample = self.active_sample()?;
        let theory = theory_of(sample.scan());
        Some(LobeDrawing {
            title: [
                format!("{}, {theory}", sample.name_of(sample.scan())),
                self.lobe_caption(),
            ],
            camera: self.solid.camera,
            ground: self.ground(),
            scene: scene.clone(),
        })
    }

    /// The surfaces that are shown.
    pub(in crate::state) fn surface_drawing(&self) -> Option<Composition> {
        let surfaces = [Some(self.subject()?), self.subject_beside()];
        let surfaces = surfaces.into_iter().flatten();
        Some(Composition {
            surfaces: surfaces.map(|surface| surface.channels.brdfs).collect(),
            lamp: self.solid.lamp_deg.map(f64::to_radians),
            plate_psi: self.solid.plate_psi_deg.to_radians(),
            light: self.solid.light(),
            stops: self.derived_solid.stops(),
            ground: self.ground(),
        })
    }

    /// What the lobe is, in a line.
    pub fn lobe_caption(&self) -> String {
        let SolidView {
            quantity, scale, ..
        } = self.solid;
        let (quantity, rim) = match quantity {
            Quantity::Brdf => ("f_r", ", which does not vanish at 90°: open at the rim"),
            Quantity::BrdfCosine => ("f_r cos θ", ""),
        };
        let scale = match scale {
            Scale::Linear => "linear",
            Scale::Logarithmic => "logarithmic",
        };
        let psi = rounded_deg(self.lobe_psi());
        let readings = self.lobe_readings().map_or_else(String::new, |measured| {
            let at = rounded_deg(measured.psi);
            format!("; readings at {at}°, rings behind or inside the lobe")
        });
        let missing = self.derived_solid.lobe().map_or(0, LobeScene::not_shown);
        let missing = match missing {
            0 => String::new(),
            count => format!(", {count} without a radius not shown"),
        };
        let beside = self.subject_beside();
        let beside = beside.map_or_else(String::new, |other| format!("; lines: {}", other.name));
        format!("{quantity} / (1/sr) at ψ = {psi}°{rim}, {scale} radius{readings}{missing}{beside}")
    }

    /// How the surface is lit and exposed, in a line.
    pub fn surface_caption(&self) -> String {
        let [stops, plate] = self.derived_solid.stops();
        let automatic = if self.solid.stops.is_none() {
            ", automatic"
        } else {
            ""
        };
        format!(
            "Exposure: ball × {} ({stops} stops{automatic}), plate × {} ({plate} stops, its brightest place \
             is next to white). At × 1 a perfect diffuser, f_r = 1/π, facing all the light is white. Lamp \
             and uniform sky; no shadows, one reflection.",
            two_digits(stops.exp2()),
            two_digits(plate.exp2())
        )
    }
}

/// An angle in radians as degrees, rounded to 0.01 deg.
fn rounded_deg(angle: f64) -> f64 {
    (angle.to_degrees() * 100.0).round() / 100.0
}

/// The model and its parameters.
fn theory_of(scan: &Scan) -> String {
    let parameters = scan.parameters;
    let values = parameters.model_parameters().into_iter();
    let values: Vec<String> = values
        .map(|p| format!("{p} = {:.4}", p.of(&parameters.values)))
        .collect();
    format!("{}: {}", parameters.model, values.join(", "))
}
