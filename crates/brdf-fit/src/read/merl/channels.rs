//! The channels of a table, and the conversion of their values to readings.

use super::bins::Bins;
use super::header::VALUE;
use crate::scan::Measurement;

/// A channel of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// The first channel.
    Red,
    /// The second channel.
    Green,
    /// The third channel.
    Blue,
}

impl Channel {
    /// All channels, in the order of the file.
    pub const ALL: [Self; 3] = [Self::Red, Self::Green, Self::Blue];

    /// The name of the channel.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
        }
    }

    /// The wavelength that is assigned to the channel, in micrometres: the dominant wavelength of the
    /// sRGB primary (IEC 61966-2-1) against its white point.
    pub const fn wavelength_um(self) -> f64 {
        match self {
            Self::Red => 0.611,
            Self::Green => 0.549,
            Self::Blue => 0.464,
        }
    }

    /// The scale of the values: f_r in 1/sr is a value times this factor.
    pub fn scale(self) -> f64 {
        match self {
            Self::Red => 1.0 / 1500.0,
            Self::Green => 1.15 / 1500.0,
            Self::Blue => 1.66 / 1500.0,
        }
    }

    /// The reading of a value at psi, theta and phi in radians.
    pub(super) fn reading(self, value: f64, [psi, theta, phi]: [f64; 3]) -> Measurement {
        Measurement {
            wavelength_um: Some(self.wavelength_um()),
            psi,
            theta,
            phi,
            brdf: value * self.scale(),
            sigma: None,
        }
    }
}

/// A value that is not a finite number.
#[derive(Debug, thiserror::Error)]
#[error(
    "{}, bin ({}, {}, {}): {value} is not a finite number: expected f_r, or a negative number for a \
     bin that was not measured",
    channel.name(), bin[0], bin[1], bin[2]
)]
pub(super) struct NotFinite {
    channel: Channel,
    /// The indices of `theta_h`, `theta_d` and `phi_d`.
    bin: [usize; 3],
    value: f64,
}

impl NotFinite {
    /// # Errors
    ///
    /// The value is not a finite number.
    pub(super) fn check(channel: Channel, bin: [usize; 3], value: f64) -> Result<f64, Self> {
        if value.is_finite() {
            return Ok(value);
        }
        Err(Self {
            channel,
            bin,
            value,
        })
    }
}

/// The readings of the bins of one `theta_h`, with the numbers of bins that are left out.
#[derive(Default)]
pub(super) struct Slab {
    pub(super) readings: Vec<Measurement>,
    pub(super) omitted: Omitted,
}

impl Slab {
    /// Converts the bytes of the values of slab i.
    ///
    /// # Errors
    ///
    /// A value is not a finite number.
    pub(super) fn new(
        bins: Bins,
        channel: Channel,
        i: usize,
        values: &[u8],
    ) -> Result<Self, NotFinite> {
        let mut slab = Self::default();
        let centre = bins.centres_of_slab(i);
        for (bin, value) in values.as_chunks::<VALUE>().0.iter().enumerate() {
            let (j, k) = (bin / bins.phi_d, bin % bins.phi_d);
            let value = NotFinite::check(channel, [i, j, k], f64::from_le_bytes(*value))?;
            match centre(j, k) {
                Some(_) if value < 0.0 => slab.omitted.not_measured += 1,
                None if value >= 0.0 => slab.omitted.below_horizon += 1,
                None => {}
                Some(angles) => slab.readings.push(channel.reading(value, angles)),
            }
        }
        Ok(slab)
    }
}

/// The numbers of bins that are left out.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Omitted {
    pub(super) not_measured: usize,
    pub(super) below_horizon: usize,
}

impl Omitted {
    pub(super) fn add(&mut self, other: Self) {
        self.not_measured += other.not_measured;
        self.below_horizon += other.below_horizon;
    }

    /// The sentence that reports them; `None` where no bin was left out.
    pub(super) fn sentence(self) -> Option<String> {
        let bins = |count: usize, which: &str| (count > 0).then(|| format!("{count} {which}"));
        let parts = [
            bins(self.not_measured, "bins that were not measured (negative)"),
            bins(self.below_horizon, "measured bins below the horizon"),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| format!("left out: {}", parts.join(", ")))
    }
}
