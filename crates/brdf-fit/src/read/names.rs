//! What the name of a column says: the role of the column and its unit.
//!
//! A name is compared without regard to case, spaces and punctuation. Its unit stands in brackets or at
//! its end: `theta_i (deg)`, `Wavelength [nm]`, `psi_rad`, `R%`.

use super::conversion::{Kind, Quantity, Scale};
use super::number::parse_number;

/// The unit of an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AngleForm {
    /// Degrees, as the name says.
    Degrees,
    /// Radians.
    Radians,
    /// The cosine of the angle.
    Cosine,
    /// The name does not say.
    Unstated,
}

/// The unit of a wavelength.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LengthUnit {
    Micrometres,
    Nanometres,
    /// The name does not say.
    Unstated,
}

/// The polarisation of the source or of the receiver relative to the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Polarisation {
    S,
    P,
}

/// The role of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Role {
    /// The incidence zenith angle.
    Psi(AngleForm),
    /// The view zenith angle.
    Theta(AngleForm),
    /// The azimuth of the source.
    SourceAzimuth(AngleForm),
    /// The azimuth of the view, or its difference from that of the source.
    ViewAzimuth(AngleForm),
    /// A zenith angle of the source or of the view (`theta_s`): the other columns decide.
    ThetaS(AngleForm),
    /// An azimuth of the source or of the view (`phi_s`): the other columns decide.
    PhiS(AngleForm),
    /// The reading.
    Value(Quantity),
    /// The reading with one polarisation.
    Polarised(Polarisation, Quantity),
    /// The reading at a wavelength in micrometres.
    Channel(f64),
    /// The wavelength.
    Wavelength(LengthUnit),
    /// The standard deviation of the reading, in its quantity.
    Sigma,
    /// The refractive index.
    Index,
    /// The signal of the sample.
    Signal,
    /// The signal of a white standard in its place.
    Reference,
    /// What tells repeated readings apart, or says nothing about them: a number, a time, a note.
    Label,
}

impl Role {
    /// The role of a column by its name; `None` where the name is not known or says too little.
    pub(super) fn named(name: &str) -> Option<Self> {
        let name = Name::of(name);
        channel(&name)
            .or_else(|| cosine(&name))
            .or_else(|| angle(&name))
            .or_else(|| value(&name))
            .or_else(|| other(&name))
    }

    /// The role in words, for messages.
    pub(super) fn in_words(self) -> String {
        let angle = |what: &str, form| match form {
            AngleForm::Degrees => format!("{what} in deg"),
            AngleForm::Radians => format!("{what} in rad"),
            AngleForm::Cosine => format!("cosine of the {what}"),
            AngleForm::Unstated => format!("{what}, taken in deg"),
        };
        match self {
            Self::Psi(form) => angle("incidence angle", form),
            Self::Theta(form) => angle("view angle", form),
            Self::ThetaS(form) => angle("zenith angle of source or view", form),
            Self::SourceAzimuth(form) => angle("source azimuth", form),
            Self::ViewAzimuth(form) => angle("view azimuth", form),
            Self::PhiS(form) => angle("azimuth of source or view", form),
            Self::Value(quantity) => quantity.to_string(),
            Self::Polarised(Polarisation::S, quantity) => format!("{quantity}, s-polarised"),
            Self::Polarised(Polarisation::P, quantity) => format!("{quantity}, p-polarised"),
            Self::Channel(um) => format!("reading at {um} um"),
            Self::Wavelength(LengthUnit::Micrometres) => "wavelength in um".to_owned(),
            Self::Wavelength(LengthUnit::Nanometres) => "wavelength in nm".to_owned(),
            Self::Wavelength(LengthUnit::Unstated) => "wavelength".to_owned(),
            Self::Sigma => "standard deviation of the reading".to_owned(),
            Self::Index => "refractive index".to_owned(),
            Self::Signal => "signal of the sample".to_owned(),
            Self::Reference => "signal of the white standard".to_owned(),
            Self::Label => "label, not used".to_owned(),
        }
    }
}

/// The quantity of a `# quantity:` comment or of a column of readings; `None` for any other text.
pub(super) fn quantity_named(name: &str) -> Option<Quantity> {
    match value(&Name::of(name)) {
        Some(Role::Value(quantity)) => Some(quantity),
        _ => None,
    }
}

/// A name in lower case: its words without the unit, run together, and the unit.
struct Name {
    stem: String,
    unit: Option<Unit>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Unit {
    Degrees,
    Radians,
    Nanometres,
    Micrometres,
    Percent,
    Decibel,
    PerSteradian,
}

impl Name {
    fn of(name: &str) -> Self {
        let mut words = words(name);
        let mut unit = None;
        while unit.is_none() && words.len() > 1 {
            let Some((found, length)) = unit_at_end(&words) else {
                break;
            };
            // A name such as "n" or "m" alone is not a unit.
            if length >= words.len() {
                break;
            }
            words.truncate(words.len() - length);
            unit = Some(found);
        }
        Self {
            stem: words.concat(),
            unit,
        }
    }
}

/// The words of a name in lower case. A number and the letters behind it are two words.
fn words(name: &str) -> Vec<String> {
    let mut spaced = String::new();
    let mut before = ' ';
    for c in name.trim().trim_matches('"').to_lowercase().chars() {
        match c {
            'θ' | 'ϑ' => spaced.push_str("theta"),
            'φ' | 'ϕ' => spaced.push_str("phi"),
            'ψ' => spaced.push_str("psi"),
            'λ' => spaced.push_str("lambda"),
            'σ' => spaced.push_str("sigma"),
            'µ' | 'μ' if before.is_ascii_digit() => spaced.push_str(" u"),
            'µ' | 'μ' => spaced.push_str("mu"),
            '%' => spaced.push_str(" percent "),
            '°' => spaced.push_str(" deg "),
            c if c.is_alphanumeric() || c == '.' => {
                if before.is_ascii_digit() && c.is_alphabetic() && c != 'e' {
                    spaced.push(' ');
                }
                spaced.push(c);
            }
            _ => spaced.push(' '),
        }
        before = c;
    }
    spaced
        .split_whitespace()
        .map(|word| match word {
            "mum" => "um".to_owned(),
            word => word.to_owned(),
        })
        .collect()
}

/// The unit at the end of a name, and the number of its words.
fn unit_at_end(words: &[String]) -> Option<(Unit, usize)> {
    let (last, before) = words.split_last()?;
    let before = before.last().map_or("", String::as_str);
    let one = |unit| Some((unit, 1));
    match last.as_str() {
        "deg" | "degree" | "degrees" => one(Unit::Degrees),
        "rad" | "radian" | "radians" => one(Unit::Radians),
        "nm" | "nanometers" | "nanometres" => one(Unit::Nanometres),
        "um" | "micron" | "microns" | "micrometers" | "micrometres" => one(Unit::Micrometres),
        "percent" | "pct" => one(Unit::Percent),
        "db" => one(Unit::Decibel),
        "sr" if before == "per" || before == "1" => Some((Unit::PerSteradian, 2)),
        "1" if before == "sr" => Some((Unit::PerSteradian, 2)),
        "sr1" => one(Unit::PerSteradian),
        _ => None,
    }
}

fn channel(name: &Name) -> Option<Role> {
    let number = parse_number(name.stem.as_bytes(), false).filter(|number| *number > 0.0)?;
    match name.unit {
        Some(Unit::Nanometres) => {
            super::number::micrometres(name.stem.as_bytes()).map(Role::Channel)
        }
        Some(Unit::Micrometres) => Some(Role::Channel(number)),
        _ => None,
    }
}

fn cosine(name: &Name) -> Option<Role> {
    let role = match name.stem.as_str() {
        "mui" | "muin" | "mu0" | "muinc" => Some(Role::Psi(AngleForm::Cosine)),
        "muo" | "muout" | "mur" | "muv" => Some(Role::Theta(AngleForm::Cosine)),
        stem => zenith_or_azimuth(stem.strip_prefix("cos")?, AngleForm::Cosine),
    };
    role.filter(|_| name.unit.is_none())
}

fn angle(name: &Name) -> Option<Role> {
    let form = match name.unit {
        None => AngleForm::Unstated,
        Some(Unit::Degrees) => AngleForm::Degrees,
        Some(Unit::Radians) => AngleForm::Radians,
        Some(_) => return None,
    };
    zenith_or_azimuth(&name.stem, form)
}

fn zenith_or_azimuth(stem: &str, form: AngleForm) -> Option<Role> {
    Some(match stem {
        "psi"
        | "psii"
        | "thetai"
        | "thetain"
        | "thetainc"
        | "thetaincident"
        | "thetasource"
        | "thetasrc"
        | "incidence"
        | "incident"
        | "incidenceangle"
        | "incidentangle"
        | "angleofincidence"
        | "aoi"
        | "incidentzenith"
        | "incidencezenith"
        | "incidencezenithangle"
        | "sourcezenith"
        | "sourcezenithangle"
        | "srcz"
        | "sza"
        | "solarzenith"
        | "solarzenithangle"
        | "illuminationangle"
        | "illuminationzenith"
        | "intheta"
        | "zenithi"
        | "zenithin" => Role::Psi(form),
        "theta" | "thetar" | "thetao" | "thetaout" | "thetav" | "thetaview" | "thetareflected"
        | "view" | "viewangle" | "viewingangle" | "viewzenith" | "viewzenithangle" | "viewz"
        | "vza" | "scatter" | "scatterangle" | "measure" | "measureangle" | "measuredangle"
        | "measurementangle" | "reflectionangle" | "reflectedangle" | "exitangle"
        | "emissionangle" | "emergenceangle" | "outgoingangle" | "outtheta" | "receiverangle"
        | "observationangle" | "zenitho" | "zenithout" | "zenithr" | "zenithv" => Role::Theta(form),
        "thetas" => Role::ThetaS(form),
        "phi"
        | "phir"
        | "phio"
        | "phiout"
        | "phiv"
        | "phiview"
        | "dphi"
        | "deltaphi"
        | "azimuth"
        | "azimuthangle"
        | "relativeazimuth"
        | "relativeazimuthangle"
        | "relaz"
        | "raa"
        | "viewazimuth"
        | "viewazimuthangle"
        | "viewa"
        | "vaa"
        | "outphi" => Role::ViewAzimuth(form),
        "phii" | "phiin" | "phiinc" | "phisource" | "sourceazimuth" | "sourceazimuthangle"
        | "incidentazimuth" | "incidenceazimuth" | "srca" | "saa" | "solarazimuth" | "inphi" => {
            Role::SourceAzimuth(form)
        }
        "phis" => Role::PhiS(form),
        _ => return None,
    })
}

fn value(name: &Name) -> Option<Role> {
    let (kind, logarithm) = match name.stem.as_str() {
        "brdf" | "bsdf" | "fr" | "brdfvalue" => (Kind::Brdf, false),
        "brdfs" => return polarised(Polarisation::S, name),
        "brdfp" => return polarised(Polarisation::P, name),
        "ccbrdf" | "ccbsdf" | "brdfcos" | "brdfcostheta" | "cosinecorrectedbrdf" | "dsf" => {
            (Kind::BrdfCos, false)
        }
        "reflectancefactor" | "brf" | "bidirectionalreflectancefactor" | "radiancefactor" => {
            (Kind::ReflectanceFactor, false)
        }
        // A reflectance per direction is a reflectance factor; only the unit tells it from f_r.
        "reflectance" | "r" if name.unit == Some(Unit::Percent) => (Kind::ReflectanceFactor, false),
        "logbrdf" | "log10brdf" | "lgbrdf" | "logbsdf" | "log10bsdf" => (Kind::Brdf, true),
        _ => return None,
    };
    let scale = match name.unit {
        _ if logarithm => Scale::Log10,
        Some(Unit::Percent) if kind == Kind::ReflectanceFactor => Scale::Percent,
        Some(Unit::Decibel) => Scale::Decibel,
        Some(Unit::PerSteradian) if kind != Kind::ReflectanceFactor => Scale::One,
        None => Scale::One,
        Some(_) => return None,
    };
    Some(Role::Value(Quantity { kind, scale }))
}

fn polarised(polarisation: Polarisation, name: &Name) -> Option<Role> {
    let stated = matches!(name.unit, None | Some(Unit::PerSteradian));
    stated.then_some(Role::Polarised(polarisation, Quantity::BRDF))
}

fn other(name: &Name) -> Option<Role> {
    let length = match name.unit {
        None => Some(LengthUnit::Unstated),
        Some(Unit::Nanometres) => Some(LengthUnit::Nanometres),
        Some(Unit::Micrometres) => Some(LengthUnit::Micrometres),
        Some(_) => None,
    };
    let stated = matches!(name.unit, None | Some(Unit::PerSteradian));
    match name.stem.as_str() {
        "wavelength" | "lambda" | "wl" | "wvl" => length.map(Role::Wavelength),
        "sigma" | "std" | "stdev" | "stddev" | "standarddeviation" | "sigmabrdf" | "brdfsigma"
        | "brdfstd" | "stdbrdf"
            if stated =>
        {
            Some(Role::Sigma)
        }
        "n" | "refractiveindex" | "ior" if name.unit.is_none() => Some(Role::Index),
        "signal" | "samplesignal" => Some(Role::Signal),
        "reference" | "referencesignal" | "whitesignal" => Some(Role::Reference),
        "ignore" | "ignored" | "repeat" | "repetition" | "run" | "index" | "no" | "nr" | "id"
        | "date" | "time" | "datetime" | "timestamp" | "comment" | "comments" | "note"
        | "notes" | "remark" | "remarks" => Some(Role::Label),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_names_that_people_use_are_known() {
        use AngleForm::{Cosine, Degrees, Radians, Unstated};
        for (name, role) in [
            ("psi_deg", Role::Psi(Degrees)),
            ("Incident_angle", Role::Psi(Unstated)),
            (" AOI (deg)", Role::Psi(Degrees)),
            ("theta_i [rad]", Role::Psi(Radians)),
            ("\"ThetaR\"", Role::Theta(Unstated)),
            ("Measure_angle", Role::Theta(Unstated)),
            ("θ_r (°)", Role::Theta(Degrees)),
            ("cos theta_i", Role::Psi(Cosine)),
            ("mu_out", Role::Theta(Cosine)),
            ("cosdphi", Role::ViewAzimuth(Cosine)),
            ("phi_i", Role::SourceAzimuth(Unstated)),
            ("theta_s", Role::ThetaS(Unstated)),
            ("Wavelength (nm)", Role::Wavelength(LengthUnit::Nanometres)),
            ("λ/µm", Role::Wavelength(LengthUnit::Micrometres)),
            ("lambda", Role::Wavelength(LengthUnit::Unstated)),
            ("wavelength_um", Role::Wavelength(LengthUnit::Micrometres)),
            (" 390nm ", Role::Channel(0.39)),
            ("0.63 um", Role::Channel(0.63)),
            ("sigma_per_sr", Role::Sigma),
            ("n", Role::Index),
            ("brdf_s", Role::Polarised(Polarisation::S, Quantity::BRDF)),
        ] {
            assert_eq!(Role::named(name), Some(role), "{name}");
        }
    }

    #[test]
    fn quantities_and_their_scales_are_known() {
        use Kind::{Brdf, BrdfCos, ReflectanceFactor};
        for (name, kind, scale) in [
            ("brdf_per_sr", Brdf, Scale::One),
            ("BRDF (1/sr)", Brdf, Scale::One),
            ("BRDF [sr^-1]", Brdf, Scale::One),
            ("f_r", Brdf, Scale::One),
            ("CCBRDF", BrdfCos, Scale::One),
            ("brdf_cos", BrdfCos, Scale::One),
            ("R%", ReflectanceFactor, Scale::Percent),
            ("reflectance_percent", ReflectanceFactor, Scale::Percent),
            (
                "reflectance_factor_percent",
                ReflectanceFactor,
                Scale::Percent,
            ),
            ("Reflectance factor", ReflectanceFactor, Scale::One),
            ("LOG_BRDF", Brdf, Scale::Log10),
            ("BRDF (dB)", Brdf, Scale::Decibel),
        ] {
            assert_eq!(
                quantity_named(name),
                Some(Quantity { kind, scale }),
                "{name}"
            );
        }
    }

    #[test]
    fn names_that_say_too_little_have_no_role() {
        for name in [
            "reflectance",
            "value",
            "x",
            "",
            "450",
            "detector_deg",
            "tilt_deg",
            "scattering angle",
            "brdf_percent",
            "psi_nm",
            "wavelength_deg",
            "deg",
            "luminance",
            "btdf",
        ] {
            assert_eq!(Role::named(name), None, "{name}");
        }
    }
}
