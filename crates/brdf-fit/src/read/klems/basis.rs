//! Bases: the hemisphere divided into rings and patches.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::{Xml, content};
use crate::read::error::ReadError;
use crate::read::text::quotable;

/// The largest number of patches of a basis.
const MOST_PATCHES: usize = 4096;

/// A ring of patches.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ring {
    /// The zenith angle of the centres of the patches in degrees.
    theta_deg: f64,
    patches: usize,
}

/// The rings from the normal outwards.
pub(super) struct Basis {
    rings: Vec<Ring>,
}

/// The bases of LBNL: the upper zenith angle of each ring in degrees, and the number of its patches.
const KNOWN: [(&str, &[(f64, usize)]); 3] = [
    (
        "LBNL/Klems Full",
        &[
            (5.0, 1),
            (15.0, 8),
            (25.0, 16),
            (35.0, 20),
            (45.0, 24),
            (55.0, 24),
            (65.0, 24),
            (75.0, 16),
            (90.0, 12),
        ],
    ),
    (
        "LBNL/Klems Half",
        &[
            (6.5, 1),
            (19.5, 8),
            (32.5, 12),
            (46.5, 16),
            (61.5, 20),
            (76.5, 12),
            (90.0, 4),
        ],
    ),
    (
        "LBNL/Klems Quarter",
        &[(9.0, 1), (27.0, 8), (46.0, 12), (66.0, 12), (90.0, 8)],
    ),
];

/// The bases that a file defines.
pub(super) struct Definitions<'a> {
    /// By their names in lower case; of several with one name, the first.
    named: BTreeMap<String, Node<'a, 'a>>,
}

impl<'a> Definitions<'a> {
    pub(super) fn of(xml: &Xml<'a>) -> Self {
        let mut named = BTreeMap::new();
        for name in xml.all("AngleBasisName") {
            if let Some(basis) = name.parent_element() {
                named.entry(content(name).to_lowercase()).or_insert(basis);
            }
        }
        Self { named }
    }

    /// The name of the only basis.
    fn only(&self) -> Option<&str> {
        let mut names = self.named.keys();
        names
            .next()
            .filter(|_| self.named.len() == 1)
            .map(String::as_str)
    }

    /// The basis of a block, which its element `element` names: one that the file defines, or a known
    /// one. Where the block names none, the only one of the file.
    ///
    /// # Errors
    ///
    /// The basis is not known, or its definition is not valid.
    pub(super) fn basis(
        &self,
        xml: &Xml<'_>,
        block: Node<'_, '_>,
        element: &str,
    ) -> Result<Basis, ReadError> {
        let mut named = block.descendants();
        let named = named
            .find(|node| node.tag_name().name() == element)
            .map(content);
        let Some(name) = named.or(self.only()) else {
            let message = format!("the block has no {element}: expected the name of a basis");
            return Err(xml.error(block, message));
        };
        let definition = self.named.get(&name.to_lowercase());
        let rings = definition.map(|basis| rings_in(xml, *basis)).transpose()?;
        let known = || {
            KNOWN
                .iter()
                .find(|(known, _)| name.eq_ignore_ascii_case(known))
        };
        match (rings.filter(|rings| !rings.is_empty()), known()) {
            (Some(rings), _) => Ok(Basis { rings }),
            (None, Some((_, known))) => Ok(Basis::known(known)),
            (None, None) => {
                let message = format!(
                    "the basis \"{}\" is not known: expected LBNL/Klems Full, Half or Quarter, or one \
                     that the file defines",
                    quotable(name.as_bytes())
                );
                Err(xml.error(block, message))
            }
        }
    }
}

impl Basis {
    fn known(upper: &[(f64, usize)]) -> Self {
        let mut lower = 0.0;
        let ring = |&(upper, patches): &(f64, usize)| {
            let ring = Ring {
                theta_deg: centre(lower, upper, patches),
                patches,
            };
            lower = upper;
            ring
        };
        Self {
            rings: upper.iter().map(ring).collect(),
        }
    }

    /// Zenith angle and azimuth of the centre of each patch, in degrees and in the order of the numbers.
    pub(super) fn directions(&self) -> Vec<(f64, f64)> {
        let patches = |ring: &Ring| {
            let Ring { theta_deg, patches } = *ring;
            let azimuth = move |i| 360.0 * i as f64 / patches as f64;
            (0..patches).map(move |i| (theta_deg, azimuth(i)))
        };
        self.rings.iter().flat_map(patches).collect()
    }
}

/// The zenith angle of the centre of the patches of a ring: the only patch of a ring around the normal is
/// centred there.
fn centre(lower: f64, upper: f64, patches: usize) -> f64 {
    if lower == 0.0 && patches == 1 {
        0.0
    } else {
        f64::midpoint(lower, upper)
    }
}

/// The rings that a file defines.
fn rings_in(xml: &Xml<'_>, basis: Node<'_, '_>) -> Result<Vec<Ring>, ReadError> {
    let mut rings = Vec::new();
    let mut patches_before = 0;
    let blocks = basis.children();
    for ring in blocks.filter(|node| node.tag_name().name() == "AngleBasisBlock") {
        let number = |name: &str| {
            let mut all = ring.descendants();
            let found = all.find(|node| node.tag_name().name() == name).map(content);
            let parsed = found.and_then(|text| text.parse::<f64>().ok());
            parsed
                .filter(|degrees| (0.0..=90.0).contains(degrees))
                .ok_or_else(|| {
                    let message = format!("{name} is missing or no number: expected 0 to 90 deg");
                    xml.error(ring, message)
                })
        };
        let (lower, upper) = (number("LowerTheta")?, number("UpperTheta")?);
        let mut all = ring.descendants();
        let count = all
            .find(|node| node.tag_name().name() == "nPhis")
            .map(content);
        let patches = count.and_then(|text| text.parse::<usize>().ok());
        let patches =
            patches.filter(|patches| (1..=MOST_PATCHES - patches_before).contains(patches));
        let Some(patches) = patches else {
            let message =
                format!("nPhis: expected 1 or more, and up to {MOST_PATCHES} patches in all");
            return Err(xml.error(ring, message));
        };
        patches_before += patches;
        rings.push(Ring {
            theta_deg: centre(lower, upper, patches),
            patches,
        });
    }
    Ok(rings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_known_bases_have_their_numbers_of_patches() {
        let counts = KNOWN.map(|(_, rings)| Basis::known(rings).directions().len());
        assert_eq!(counts, [145, 73, 41]);
    }

    #[test]
    fn patches_are_numbered_from_the_normal_by_azimuth() {
        let directions = Basis::known(KNOWN[0].1).directions();
        let expected = [(0.0, 0.0), (10.0, 0.0), (10.0, 45.0), (10.0, 90.0)];
        assert_eq!(directions[..4], expected);
        assert_eq!(directions[144], (82.5, 330.0));
    }
}
