//! The error of an export.

use std::io;

use brdf_core::GeometryError;

use super::interpolated::{MAX_ENTRIES, Unreachable};
use super::material::SelectionError;
use super::nearest_bin::LookupError;
use super::source::NameError;

/// Why a material cannot be exported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The format takes other fits than those of the material, such as only one.
    #[error(transparent)]
    Selection(#[from] SelectionError),
    /// An interpolated table within the tolerance would be too large.
    #[error(
        "a table within the tolerance {tolerance:e} has more than {MAX_ENTRIES} entries: expected {}",
        expected(*.reachable, *.fits)
    )]
    Tolerance {
        /// The given tolerance, a relative error of f_r.
        tolerance: f64,
        /// About the smallest one that a table satisfies; `None` where the lobe is too narrow for any.
        reachable: Option<f64>,
        /// The number of fits in the table.
        fits: usize,
    },
    /// The bins of a MERL table are too wide for the tolerance.
    #[error(
        "the maximum error of a MERL table exceeds the tolerance {tolerance:e} ({found}): expected no \
         tolerance, or another format"
    )]
    Bins {
        /// The given tolerance, a relative error of f_r.
        tolerance: f64,
        /// The error of the table.
        found: LookupError,
    },
    /// An angle is outside the domain of the model.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The name cannot be the prefix of the names in source code.
    #[error(transparent)]
    Name(#[from] NameError),
    /// The output cannot be written.
    #[error(transparent)]
    Io(#[from] io::Error),
}

impl ExportError {
    /// The error of an interpolated table that would be too large.
    pub(super) fn tolerance(tolerance: f64, unreachable: &Unreachable) -> Self {
        Self::Tolerance {
            tolerance,
            reachable: Some(unreachable.reachable).filter(|reachable| *reachable < 1.0),
            fits: unreachable.channels,
        }
    }
}

fn expected(reachable: Option<f64>, fits: usize) -> String {
    match (reachable, fits) {
        (Some(tolerance), _) => format!("a tolerance of about {tolerance:.1e} or more"),
        (None, 1) => "source code, because the lobe is too narrow for a table".to_owned(),
        (None, _) => format!(
            "fewer fits than {fits}, or source code, because the lobes are too narrow for one table of all"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_no_table_suffices_a_table_of_fewer_fits_may() {
        let error = |channels| {
            let unreachable = Unreachable {
                reachable: 1.0,
                channels,
            };
            ExportError::tolerance(0.05, &unreachable).to_string()
        };
        assert!(!error(1).contains("fewer"), "{}", error(1));
        let many = error(60_000);
        assert!(
            many.contains("expected fewer fits than 60000, or source code"),
            "{many}"
        );
    }
}
