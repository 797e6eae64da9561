//! LBNL WINDOW XML files (`.xml`) with BSDFs over the patches of a Klems basis, as WINDOW and the programs
//! of Radiance write them. Their reflection is read.
//!
//! ```text
//! <WindowElement><Optical><Layer>
//!   <Material><Name>Test paint</Name></Material>
//!   <DataDefinition>
//!     <IncidentDataStructure>Columns</IncidentDataStructure>
//!     <AngleBasis><AngleBasisName>LBNL/Klems Full</AngleBasisName> ... </AngleBasis>
//!   </DataDefinition>
//!   <WavelengthData>
//!     <Wavelength unit="Integral">Visible</Wavelength>
//!     <WavelengthDataBlock>
//!       <WavelengthDataDirection>Reflection Front</WavelengthDataDirection>
//!       <ColumnAngleBasis>LBNL/Klems Full</ColumnAngleBasis>
//!       <RowAngleBasis>LBNL/Klems Full</RowAngleBasis>
//!       <ScatteringData>0.10, 0.11, ... </ScatteringData>
//!     </WavelengthDataBlock>
//!   </WavelengthData>
//! </Layer></Optical></WindowElement>
//! ```
//!
//! (The numbers are made up.)
//!
//! # Conventions
//!
//! A basis divides the hemisphere into rings of zenith angles, and each ring into patches of equal
//! azimuths; the first patch of a ring is centred at azimuth 0. Patches are numbered from the normal
//! outwards, by azimuth within a ring. The file defines its bases, or names one of the three of LBNL
//! (`Full` with 145 patches, `Half` with 73, `Quarter` with 41).
//!
//! `Columns` means that the values of an outgoing patch stand in a row, one for each incident patch; with
//! `Rows` it is the reverse. Values are f_r in 1/sr, averaged over both patches, each weighted by its
//! projected solid angle. A reading is taken at the centres of the two patches: at the middle of the
//! zenith angles of the ring, or at the normal for a patch around it. **What is narrower than a patch, such
//! as the lobe of a glossy sample, is smeared.**
//!
//! The azimuth of an incident patch is that of the light's way: a patch and the incident one of the same
//! number are the specular directions of each other. The model's phi is phi_out - phi_in + 180 deg.
//!
//! # What is read, and what is an error
//!
//! `Reflection Front` is read, and `Reflection Back` where it is the only one; of the spectra those with a
//! wavelength, otherwise `Visible`, otherwise the only one. The report says what was not read. Errors are
//! transmission only, tensor trees, and several spectra of which none is `Visible`.
//!
//! Sources: `src/common/bsdf_m.c` of Radiance (github.com/NREL/Radiance), which has the bases, the order of
//! the values and the directions of the patches; `src/util/genBSDF.pl` there, which writes such files.

mod basis;
mod blocks;

use std::path::Path;

use roxmltree::{Document, Node};

use super::angles::{AngleUnit, TwoDirections};
use super::conversion::{BEYOND_HORIZON, left_out};
use super::error::ReadError;
use super::options::ReadOptions;
use super::reader::{Content, Reader};
use super::text::{HEAD, quotable, without_byte_order_mark};
use crate::scan::{Convention, Format, Measurement, Measurements, Metadata};
use basis::Definitions;
use blocks::{Block, Chosen};

pub(super) const READER: Reader = Reader {
    format: Format::Klems,
    extensions: &["xml"],
    recognises: is_window_element,
    content: Content::Bytes(read),
};

/// The name of the root element.
const ROOT: &str = "WindowElement";

fn is_window_element(bytes: &[u8]) -> bool {
    let head = without_byte_order_mark(bytes.get(..HEAD).unwrap_or(bytes)).trim_ascii_start();
    let root = b"<WindowElement";
    head.starts_with(b"<") && head.windows(root.len()).any(|window| window == root)
}

/// # Errors
///
/// The bytes are not such a file with reflection, or `options` set another angular convention.
fn read(path: &Path, bytes: &[u8], options: &ReadOptions) -> Result<Measurements, ReadError> {
    let why = "the patches of a Klems basis are counted from the normal, with azimuths of the light's \
               way";
    let convention = options.fixed_convention(path, Convention::default(), why)?;
    let text = str::from_utf8(without_byte_order_mark(bytes));
    let text =
        text.map_err(|_| ReadError::file(path, "is not UTF-8: expected a WINDOW XML file"))?;
    let document = Document::parse(text).map_err(|error| not_xml(path, &error))?;
    let xml = Xml {
        path,
        document: &document,
    };
    let root = document.root_element();
    if root.tag_name().name() != ROOT {
        let message = format!(
            "the root element is {}: expected {ROOT}",
            quotable(root.tag_name().name().as_bytes())
        );
        return Err(xml.error(root, message));
    }
    let structure = xml.structure()?;
    let chosen = Chosen::of(&xml)?;
    let mut found = Found::default();
    let bases = Definitions::of(&xml);
    for block in &chosen.blocks {
        found.add(&xml, &bases, block, structure)?;
    }
    if found.readings.is_empty() {
        return Err(ReadError::file(path, "has no reading above the surface"));
    }
    let mut conversions = vec![
        "values are averages over the patches of a Klems basis: they are read at the centres of the \
         patches"
            .to_owned(),
        "azimuths of incident patches are those of the light's way: the model's are 180 deg from them"
            .to_owned(),
    ];
    conversions.extend(chosen.conversions());
    conversions.extend(left_out(found.beyond, BEYOND_HORIZON));
    let name = child(root, "Material").and_then(|material| child(material, "Name"));
    let name = name.and_then(|name| name.text()).unwrap_or_default().trim();
    let sample = (!name.is_empty()).then(|| ("sample".to_owned(), name.to_owned()));
    let spectrum = chosen.spectrum.map(|name| ("spectrum".to_owned(), name));
    Ok(Measurements {
        source: path.display().to_string(),
        metadata: Metadata(sample.into_iter().chain(spectrum).collect()),
        convention,
        format: Format::Klems,
        conversions,
        readings: found.readings,
        ..Measurements::default()
    })
}

fn not_xml(path: &Path, error: &roxmltree::Error) -> ReadError {
    ReadError::Line {
        path: path.to_owned(),
        line: u64::from(error.pos().row),
        message: format!("is not valid XML: {error}"),
        remedy: None,
    }
}

/// The file, with the path that errors name.
#[derive(Clone, Copy)]
struct Xml<'a> {
    path: &'a Path,
    document: &'a Document<'a>,
}

/// The order of the values of a block.
#[derive(Clone, Copy, PartialEq)]
enum Structure {
    /// A column for each incident patch.
    Columns,
    /// A row for each incident patch.
    Rows,
}

impl<'a> Xml<'a> {
    /// The number of the line in which an element begins.
    fn line(&self, node: Node<'_, '_>) -> u64 {
        let start = node.range().start;
        u64::from(self.document.text_pos_at(start).row)
    }

    fn error(&self, node: Node<'_, '_>, message: impl Into<String>) -> ReadError {
        ReadError::Line {
            path: self.path.to_owned(),
            line: self.line(node),
            message: message.into(),
            remedy: None,
        }
    }

    /// All elements with a name.
    fn all(&self, name: &'static str) -> impl Iterator<Item = Node<'a, 'a>> + use<'a> {
        let all = self.document.descendants();
        all.filter(move |node| node.tag_name().name() == name)
    }

    fn structure(&self) -> Result<Structure, ReadError> {
        let Some(node) = self.all("IncidentDataStructure").next() else {
            let message = "has no IncidentDataStructure: expected a BSDF over the patches of a Klems \
                           basis";
            return Err(ReadError::file(self.path, message));
        };
        match content(node) {
            "Columns" => Ok(Structure::Columns),
            "Rows" => Ok(Structure::Rows),
            other => {
                let message = if other.starts_with("TensorTree") {
                    format!(
                        "{}: a tensor tree cannot be read because its values are not those of a fixed \
                         set of patches: expected Columns or Rows",
                        quotable(other.as_bytes())
                    )
                } else {
                    format!(
                        "\"{}\": expected Columns or Rows",
                        quotable(other.as_bytes())
                    )
                };
                Err(self.error(node, message))
            }
        }
    }
}

/// The first descendant with a name.
fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    let mut all = node.descendants();
    all.find(|node| node.tag_name().name() == name)
}

/// The text in an element, without white space around it.
fn content<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or_default().trim()
}

/// The readings of the blocks.
#[derive(Default)]
struct Found {
    readings: Vec<Measurement>,
    beyond: usize,
}

impl Found {
    fn add(
        &mut self,
        xml: &Xml<'_>,
        bases: &Definitions<'_>,
        block: &Block<'_>,
        structure: Structure,
    ) -> Result<(), ReadError> {
        let incident = bases
            .basis(xml, block.node, "ColumnAngleBasis")?
            .directions();
        let outgoing = bases.basis(xml, block.node, "RowAngleBasis")?.directions();
        let values = block.values(xml, incident.len() * outgoing.len())?;
        let mut add = |source: &(f64, f64), view: &(f64, f64), value: f64| {
            let directions = TwoDirections {
                theta_i: source.0,
                phi_i: source.1 + 180.0,
                theta_s: view.0,
                phi_s: view.1,
            };
            match directions.in_model(AngleUnit::Degrees) {
                None => self.beyond += 1,
                Some((psi, theta, phi)) => self.readings.push(Measurement {
                    wavelength_um: block.wavelength_um,
                    psi,
                    theta,
                    phi,
                    brdf: value,
                    sigma: None,
                }),
            }
        };
        let mut values = values.into_iter();
        match structure {
            Structure::Columns => {
                for view in &outgoing {
                    for (source, value) in incident.iter().zip(&mut values) {
                        add(source, view, value);
                    }
                }
            }
            Structure::Rows => {
                for source in &incident {
                    for (view, value) in outgoing.iter().zip(&mut values) {
                        add(source, view, value);
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
