//! The lobe and the pictures of the surface, computed again only if what they depend on has changed.

use std::collections::BTreeSet;
use std::sync::Arc;

use brdf_core::AnyBrdf;
use brdf_fit::plot::{Quantity, Scale};
use egui::ColorImage;

use super::subjects::Subject;
use super::view::{Solid, SolidView};
use crate::solid::surface::{
    Light, Pixels, Radiance, Sky, automatic_stops, develop, lamp_direction, shade,
    stops_for_highlights,
};
use crate::solid::{LobeScene, Spot};
use crate::state::State;
use crate::state::derived::Cached;
use crate::state::id::ScanId;

/// What a lobe depends on.
#[derive(Debug, Clone, PartialEq)]
struct LobeKey {
    brdf: AnyBrdf,
    beside: Option<AnyBrdf>,
    psi: f64,
    quantity: Quantity,
    scale: Scale,
    scan: Option<ScanId>,
    left_out: BTreeSet<usize>,
}

/// What the geometry of the pixels depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PixelsKey {
    side: usize,
    lamp_deg: [f64; 2],
    plate_psi_deg: f64,
}

/// A ball and a plate.
type Both<T> = [T; 2];

/// A picture of a surface.
#[derive(Debug, Clone)]
pub struct Pane {
    /// The name of the surface.
    pub name: String,
    /// Which wavelengths are its colours.
    pub note: String,
    /// The ball and the plate.
    pub pictures: Both<Arc<ColorImage>>,
    /// A number that changes with the pictures.
    pub revision: u64,
}

/// The cached steps of a colour.
#[derive(Debug, Clone, Default)]
struct CachedChannel {
    sky: Cached<AnyBrdf, Sky>,
    radiances: Cached<(AnyBrdf, PixelsKey, Light), Both<Radiance>>,
}

/// The cached steps of a picture.
#[derive(Debug, Clone, Default)]
struct CachedPane {
    channels: Vec<CachedChannel>,
    shown: Option<(Both<f64>, Pane)>,
}

/// The lobe and the pictures of the surface.
#[derive(Debug, Clone, Default)]
pub struct DerivedSolid {
    lobe: Cached<LobeKey, LobeScene>,
    has_lobe: bool,
    pixels: Cached<PixelsKey, Both<Pixels>>,
    panes: [CachedPane; 2],
    stops: Both<f64>,
    revision: u64,
}

impl DerivedSolid {
    /// The lobe; `None` if it is not shown, or the parameters are outside the domain of the model.
    pub fn lobe(&self) -> Option<&LobeScene> {
        self.lobe.last().filter(|_| self.has_lobe)
    }

    /// The pictures of the surfaces that are shown.
    pub fn panes(&self) -> impl Iterator<Item = &Pane> {
        let panes = self.panes.iter();
        panes.filter_map(|pane| Some(&pane.shown.as_ref()?.1))
    }

    /// The exposures of the balls and of the plates, in stops.
    pub fn stops(&self) -> Both<f64> {
        self.stops
    }

    fn refresh_lobe(&mut self, key: Option<LobeKey>, readings: impl FnOnce() -> Vec<Spot>) {
        self.has_lobe = key.is_some();
        if let Some(key) = key {
            self.lobe.get(key, |key| {
                let axes = (key.quantity, key.scale);
                LobeScene::new((&key.brdf, key.beside.as_ref()), key.psi, axes, readings())
            });
        }
    }

    fn refresh_surface(&mut self, subjects: [Option<Subject>; 2], view: &SolidView, side: usize) {
        let key = PixelsKey {
            side,
            lamp_deg: view.lamp_deg,
            plate_psi_deg: view.plate_psi_deg,
        };
        let pixels = self.pixels.get(key, |key| {
            let lamp = lamp_direction(key.lamp_deg.map(f64::to_radians));
            let psi = key.plate_psi_deg.to_radians();
            [Pixels::ball(key.side, lamp), Pixels::plate(key.side, psi)]
        });
        for (pane, subject) in self.panes.iter_mut().zip(&subjects) {
            let brdfs = subject.as_ref().map(|subject| &*subject.channels.brdfs);
            pane.shade(brdfs.unwrap_or(&[]), pixels, key, view.light());
        }
        let channels = || self.panes.iter().flat_map(|pane| &pane.channels);
        let skies = channels().filter_map(|channel| channel.sky.last());
        let ball = view.stops.unwrap_or_else(|| automatic_stops(skies));
        let plates = channels().filter_map(|channel| Some(&channel.radiances.last()?[1]));
        self.stops = [ball, stops_for_highlights(plates)];
        for (pane, subject) in self.panes.iter_mut().zip(subjects) {
            pane.develop(subject, pixels, self.stops, &mut self.revision);
        }
    }
}

impl CachedPane {
    fn shade(&mut self, brdfs: &[AnyBrdf], pixels: &Both<Pixels>, key: PixelsKey, light: Light) {
        if self.channels.len() != brdfs.len() {
            self.shown = None;
            self.channels
                .resize_with(brdfs.len(), CachedChannel::default);
        }
        for (channel, brdf) in self.channels.iter_mut().zip(brdfs) {
            let key = (*brdf, key, light);
            if channel.radiances.has(&key) {
                continue;
            }
            self.shown = None;
            let sky = channel.sky.get(*brdf, Sky::new);
            channel.radiances.get(key, |_| {
                pixels
                    .each_ref()
                    .map(|pixels| shade(pixels, brdf, sky, light))
            });
        }
    }

    fn develop(
        &mut self,
        subject: Option<Subject>,
        pixels: &Both<Pixels>,
        stops: Both<f64>,
        revision: &mut u64,
    ) {
        let Some(subject) = subject else {
            self.shown = None;
            return;
        };
        let name = subject.name;
        let note = subject.channels.note;
        if let Some((at, pane)) = &mut self.shown
            && *at == stops
        {
            (pane.name, pane.note) = (name, note);
            return;
        }
        *revision += 1;
        let picture = |i: usize| {
            let channels = self.channels.iter();
            let radiances = channels.filter_map(|channel| Some(&channel.radiances.last()?[i]));
            let radiances: Vec<&Radiance> = radiances.collect();
            Arc::new(develop(&pixels[i], &radiances, stops[i]))
        };
        let pane = Pane {
            name,
            note,
            pictures: [picture(0), picture(1)],
            revision: *revision,
        };
        self.shown = Some((stops, pane));
    }
}

impl State {
    /// Updates what is shown in three dimensions.
    pub(in crate::state) fn refresh_solid(&mut self) {
        let lobe = self.lobe_key();
        let mut derived = std::mem::take(&mut self.derived_solid);
        derived.refresh_lobe(lobe, || self.lobe_spots());
        if self.solid.shown == Some(Solid::Surface) {
            let subjects = [self.subject(), self.subject_beside()];
            derived.refresh_surface(subjects, &self.solid, self.surface_side);
        }
        self.derived_solid = derived;
    }

    fn lobe_key(&self) -> Option<LobeKey> {
        if self.solid.shown != Some(Solid::Lobe) {
            return None;
        }
        let sample = self.active_sample()?;
        Some(LobeKey {
            brdf: sample.scan().parameters.brdf()?,
            beside: self.subject_beside().map(|subject| subject.brdf),
            psi: self.lobe_psi(),
            quantity: self.solid.quantity,
            scale: self.solid.scale,
            scan: Some(sample.scan_id()),
            left_out: sample.scan().left_out().clone(),
        })
    }

    /// The readings of the lobe as its quantity.
    fn lobe_spots(&self) -> Vec<Spot> {
        let measured = self.lobe_readings();
        let readings = measured.into_iter().flat_map(|measured| measured.readings);
        let quantity = self.solid.quantity;
        let spots = readings.map(|(spot, cosine)| Spot {
            value: quantity.of(spot.value, cosine),
            ..spot
        });
        spots.collect()
    }
}
