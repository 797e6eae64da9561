//! The blocks of values: which are read, and their values.

use roxmltree::Node;

use super::{Xml, child, content};
use crate::format::counted;
use crate::read::error::ReadError;
use crate::read::number::{is_reading, micrometres, parse_number};
use crate::read::text::{lines, quotable, words};

/// A block of values of one direction and one spectrum.
pub(super) struct Block<'a> {
    pub(super) node: Node<'a, 'a>,
    direction: String,
    /// The name of the spectrum, such as `Visible`.
    spectrum: String,
    /// The wavelength in micrometres, where the spectrum is one.
    pub(super) wavelength_um: Option<f64>,
}

/// The blocks that are read, and what others there are.
pub(super) struct Chosen<'a> {
    pub(super) blocks: Vec<Block<'a>>,
    /// The name of the spectrum, unless wavelengths are read.
    pub(super) spectrum: Option<String>,
    direction: String,
    others: Vec<String>,
}

impl<'a> Chosen<'a> {
    /// # Errors
    ///
    /// There is no block of reflection, or there are several spectra of which none is to be preferred.
    pub(super) fn of(xml: &Xml<'a>) -> Result<Self, ReadError> {
        let mut blocks = Vec::new();
        for data in xml.all("WavelengthData") {
            let spectrum = Spectrum::of(xml, data)?;
            for block in data.children() {
                if block.tag_name().name() == "WavelengthDataBlock" {
                    blocks.push(Block::new(xml, &spectrum, block)?);
                }
            }
        }
        let directions = ["Reflection Front", "Reflection Back"];
        let has = |direction: &&str| blocks.iter().any(|block| block.is_in(direction));
        let Some(direction) = directions.into_iter().find(has) else {
            let found = blocks.iter().map(|block| block.direction.as_str());
            let message = if blocks.is_empty() {
                "has no WavelengthDataBlock: expected blocks of reflection".to_owned()
            } else {
                format!(
                    "has {} only, which cannot be read because the model describes reflection: \
                     expected Reflection Front",
                    list(found.into_iter())
                )
            };
            return Err(ReadError::file(xml.path, message));
        };
        let (blocks, others): (Vec<_>, Vec<_>) =
            blocks.into_iter().partition(|block| block.is_in(direction));
        let mut chosen = Self {
            blocks,
            spectrum: None,
            direction: direction.to_owned(),
            others: others.into_iter().map(|block| block.name()).collect(),
        };
        chosen.choose_spectrum(xml)?;
        Ok(chosen)
    }

    fn choose_spectrum(&mut self, xml: &Xml<'_>) -> Result<(), ReadError> {
        let blocks = std::mem::take(&mut self.blocks);
        let has_wavelengths = blocks.iter().any(|block| block.wavelength_um.is_some());
        let has_visible = blocks.iter().any(Block::is_visible);
        let is_chosen = |block: &Block<'_>| {
            if has_wavelengths {
                block.wavelength_um.is_some()
            } else {
                block.is_visible() || !has_visible
            }
        };
        let (chosen, others): (Vec<_>, Vec<_>) = blocks.into_iter().partition(is_chosen);
        self.others
            .extend(others.into_iter().map(|block| block.name()));
        if !has_wavelengths && chosen.len() > 1 {
            let spectra = chosen.iter().map(|block| block.spectrum.as_str());
            let message = format!(
                "has several blocks of {}, of {}: expected one, of the spectrum Visible",
                self.direction,
                list(spectra)
            );
            return Err(ReadError::file(xml.path, message));
        }
        self.spectrum = chosen
            .first()
            .filter(|block| block.wavelength_um.is_none())
            .map(|block| block.spectrum.clone());
        self.blocks = chosen;
        Ok(())
    }

    /// The sentences about the blocks.
    pub(super) fn conversions(&self) -> Vec<String> {
        let read = match &self.spectrum {
            Some(name) => format!("{} of the spectrum {name} is read", self.direction),
            None => format!("{} is read", self.direction),
        };
        let others = (!self.others.is_empty()).then(|| {
            let count = counted(self.others.len(), "other block");
            format!(
                "; {count} not read: {}",
                list(self.others.iter().map(String::as_str))
            )
        });
        vec![read + &others.unwrap_or_default()]
    }
}

/// The spectrum of some blocks.
struct Spectrum {
    name: String,
    /// The wavelength in micrometres, where the spectrum is one.
    wavelength_um: Option<f64>,
}

impl Spectrum {
    fn of(xml: &Xml<'_>, data: Node<'_, '_>) -> Result<Self, ReadError> {
        let mut children = data.children();
        let wavelength = children.find(|node| node.tag_name().name() == "Wavelength");
        let name = wavelength.map_or("", content);
        let unit = wavelength.and_then(|node| node.attribute("unit"));
        let wavelength_um = match wavelength.filter(|_| unit != Some("Integral")) {
            None => None,
            Some(node) => wavelength_in(xml, node, unit.unwrap_or_default(), name)?,
        };
        Ok(Self {
            name: quotable(name.as_bytes()),
            wavelength_um,
        })
    }
}

impl<'a> Block<'a> {
    fn new(xml: &Xml<'a>, spectrum: &Spectrum, node: Node<'a, 'a>) -> Result<Self, ReadError> {
        let Some(direction) = child(node, "WavelengthDataDirection") else {
            let message = "the block has no WavelengthDataDirection: expected one such as Reflection \
                           Front";
            return Err(xml.error(node, message));
        };
        Ok(Self {
            node,
            direction: quotable(content(direction).as_bytes()),
            spectrum: spectrum.name.clone(),
            wavelength_um: spectrum.wavelength_um,
        })
    }

    fn is_in(&self, direction: &str) -> bool {
        self.direction.eq_ignore_ascii_case(direction)
    }

    fn is_visible(&self) -> bool {
        self.spectrum.eq_ignore_ascii_case("Visible")
    }

    fn name(&self) -> String {
        format!("{} of {}", self.direction, self.spectrum)
    }

    /// The values, which must be `count`.
    ///
    /// # Errors
    ///
    /// A value is no number, or there are others than `count`.
    pub(super) fn values(&self, xml: &Xml<'_>, count: usize) -> Result<Vec<f64>, ReadError> {
        let Some(data) = child(self.node, "ScatteringData") else {
            return Err(xml.error(
                self.node,
                "the block has no ScatteringData: expected values",
            ));
        };
        // The line is found from the beginning of the file, and only where it is needed.
        let first = || data.first_child().map_or(1, |text| xml.line(text));
        let mut values = Vec::new();
        for (number, line) in lines(data.text().unwrap_or_default().as_bytes()) {
            for word in words(line) {
                let value = parse_number(word, false).filter(|value| is_reading(*value));
                let value = value.ok_or_else(|| ReadError::Value {
                    path: xml.path.to_owned(),
                    line: first() + number - 1,
                    column: "ScatteringData".to_owned(),
                    value: quotable(word),
                    message: "is not a number: expected a value in 1/sr".to_owned(),
                    remedy: None,
                })?;
                values.push(value);
            }
        }
        if values.len() == count {
            return Ok(values);
        }
        let message = format!(
            "{} in ScatteringData: expected {count}, one for each pair of patches",
            counted(values.len(), "value")
        );
        Err(xml.error(data, message))
    }
}

/// The wavelength in micrometres; `None` for the name of a spectrum.
fn wavelength_in(
    xml: &Xml<'_>,
    node: Node<'_, '_>,
    unit: &str,
    number: &str,
) -> Result<Option<f64>, ReadError> {
    if number.parse::<f64>().is_err() {
        return Ok(None);
    }
    let is = |names: &[&str]| names.iter().any(|name| unit.eq_ignore_ascii_case(name));
    let wavelength_um = if is(&["nm", "nanometer", "nanometers"]) {
        micrometres(number.as_bytes())
    } else if is(&["um", "micron", "microns", "micrometer", "micrometers"]) {
        number
            .parse()
            .ok()
            .filter(|um: &f64| *um > 0.0 && um.is_finite())
    } else {
        None
    };
    wavelength_um.map(Some).ok_or_else(|| {
        let message = format!(
            "the wavelength \"{}\" with the unit \"{}\": expected a positive number of Nanometers or \
             Microns",
            quotable(number.as_bytes()),
            quotable(unit.as_bytes())
        );
        xml.error(node, message)
    })
}

/// The first different words, separated by commas.
fn list<'w>(words: impl Iterator<Item = &'w str>) -> String {
    const MOST: usize = 8;
    let mut different: Vec<&str> = Vec::new();
    for word in words {
        if different.len() == MOST {
            return different.join(", ") + ", ...";
        }
        if !different.contains(&word) {
            different.push(word);
        }
    }
    different.join(", ")
}
