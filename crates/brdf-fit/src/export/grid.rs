//! The grid of angles of a CSV table, and its form as text.

use std::ops::Range;
use std::str::FromStr;

/// The largest number of points: larger tables serve nobody.
const MAX_POINTS: usize = 10_000_000;

/// The angles of a CSV table in degrees; the table has every combination of them.
///
/// It is parsed from text such as `psi=10:70:20 theta=-85:85:1 phi=0,90`: for each angle
/// `FROM:TO:STEP` or numbers separated by commas. Angles that are left out are those of the
/// default.
///
/// ```
/// use brdf_fit::export::AngleGrid;
///
/// let grid: AngleGrid = "psi=10:70:20 phi=0,90".parse()?;
/// assert_eq!(grid.psi_deg, [10.0, 30.0, 50.0, 70.0]);
/// assert_eq!(grid.theta_deg, AngleGrid::default().theta_deg);
/// # Ok::<(), brdf_fit::export::AngleGridError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct AngleGrid {
    /// Incidence zenith angles, in [0, 90).
    pub psi_deg: Vec<f64>,
    /// View zenith angles, in (-90, 90), positive on the source's side.
    pub theta_deg: Vec<f64>,
    /// View azimuths from the source's, in [-360, 360].
    pub phi_deg: Vec<f64>,
}

/// Why a text is not an [`AngleGrid`]. `part` is the part of the text between spaces.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AngleGridError {
    /// The part is not an assignment to one of the angles.
    #[error("\"{part}\": expected psi=, theta= or phi= and degrees")]
    Assignment {
        /// The part of the text.
        part: String,
    },
    /// An angle is given twice.
    #[error("\"{part}\": {name} is given twice")]
    Repeated {
        /// The second part of that angle.
        part: String,
        /// The name of the angle.
        name: String,
    },
    /// A number cannot be parsed, or is not finite.
    #[error("\"{part}\": \"{text}\" is not a number")]
    Number {
        /// The part of the text.
        part: String,
        /// The text in place of the number.
        text: String,
    },
    /// The colons do not separate three numbers.
    #[error("\"{part}\": expected FROM:TO:STEP, or numbers separated by commas")]
    Form {
        /// The part of the text.
        part: String,
    },
    /// The step is not positive, the range is empty, or there are too many steps.
    #[error("\"{part}\": expected FROM <= TO and a STEP above 0")]
    Steps {
        /// The part of the text.
        part: String,
    },
    /// An angle is outside its domain.
    #[error("\"{part}\": {angle_deg} is out of range")]
    OutOfRange {
        /// The part of the text.
        part: String,
        /// The angle in degrees.
        angle_deg: f64,
    },
    /// The combinations of the angles are too many.
    #[error("{points} points: expected at most {MAX_POINTS}")]
    TooManyPoints {
        /// Their number.
        points: usize,
    },
}

/// The plane of incidence: psi 0, 10, ... 70, theta -80, -75, ... 80 deg.
impl Default for AngleGrid {
    fn default() -> Self {
        let steps = |from: i32, to: i32, step| (from..=to).step_by(step).map(f64::from).collect();
        Self {
            psi_deg: steps(0, 70, 10),
            theta_deg: steps(-80, 80, 5),
            phi_deg: vec![0.0],
        }
    }
}

impl FromStr for AngleGrid {
    type Err = AngleGridError;

    fn from_str(text: &str) -> Result<Self, AngleGridError> {
        let mut grid = Self::default();
        let mut given = Vec::new();
        for part in text.split_whitespace() {
            let (name, angles) = part.split_once('=').ok_or_else(|| assignment(part))?;
            if given.contains(&name) {
                return Err(AngleGridError::Repeated {
                    part: part.to_owned(),
                    name: name.to_owned(),
                });
            }
            given.push(name);
            let (list, domain) = match name {
                "psi" => (&mut grid.psi_deg, 0.0..90.0),
                "theta" => (&mut grid.theta_deg, (-90.0_f64).next_up()..90.0),
                "phi" => (&mut grid.phi_deg, -360.0..360.0_f64.next_up()),
                _ => return Err(assignment(part)),
            };
            *list = parse_angles(part, angles, &domain)?;
        }
        let points = [&grid.psi_deg, &grid.theta_deg, &grid.phi_deg].map(Vec::len);
        let points = points.into_iter().fold(1_usize, usize::saturating_mul);
        if points > MAX_POINTS {
            return Err(AngleGridError::TooManyPoints { points });
        }
        Ok(grid)
    }
}

fn assignment(part: &str) -> AngleGridError {
    AngleGridError::Assignment {
        part: part.to_owned(),
    }
}

/// `FROM:TO:STEP`, or numbers separated by commas, all in the domain.
fn parse_angles(part: &str, text: &str, domain: &Range<f64>) -> Result<Vec<f64>, AngleGridError> {
    let number = |text: &str| {
        let number = text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
        number.ok_or_else(|| AngleGridError::Number {
            part: part.to_owned(),
            text: text.to_owned(),
        })
    };
    let fields: Vec<&str> = text.split(':').collect();
    let angles = match fields.as_slice() {
        [list] => list.split(',').map(number).collect::<Result<_, _>>()?,
        [from, to, step] => steps(number(from)?, number(to)?, number(step)?).ok_or_else(|| {
            AngleGridError::Steps {
                part: part.to_owned(),
            }
        })?,
        _ => {
            return Err(AngleGridError::Form {
                part: part.to_owned(),
            });
        }
    };
    match angles.iter().find(|angle| !domain.contains(*angle)) {
        Some(&angle_deg) => Err(AngleGridError::OutOfRange {
            part: part.to_owned(),
            angle_deg,
        }),
        None => Ok(angles),
    }
}

/// `None` where there is no angle, or where there are too many.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the count is checked to be in [0, MAX_POINTS)"
)]
fn steps(from: f64, to: f64, step: f64) -> Option<Vec<f64>> {
    let count = ((to - from) / step + 1e-9).floor();
    if step <= 0.0 || !(0.0..MAX_POINTS as f64).contains(&count) {
        return None;
    }
    // Removes the rounding error of the product: 0.1 * 3 becomes 0.3.
    let rounded = |angle: f64| (angle * 1e9).round() / 1e9;
    let angle = |i| rounded(from + f64::from(i) * step);
    Some((0..=count as u32).map(angle).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_is_read_from_text() {
        let grid: AngleGrid = "psi=10:70:20 theta=-0.2:0.1:0.1 phi=0,90".parse().unwrap();
        assert_eq!(grid.psi_deg, [10.0, 30.0, 50.0, 70.0]);
        assert_eq!(grid.theta_deg, [-0.2, -0.1, 0.0, 0.1]);
        assert_eq!(grid.phi_deg, [0.0, 90.0]);
        assert_eq!("".parse(), Ok(AngleGrid::default()));
    }

    #[test]
    fn invalid_grids_are_refused() {
        let error = |text: &str| text.parse::<AngleGrid>().unwrap_err().to_string();
        assert!(error("psi=90").contains("90 is out of range"));
        assert!(error("theta=-90").contains("-90 is out of range"));
        assert!(error("psi=1:2").contains("expected FROM:TO:STEP"));
        assert!(error("psi=1:2:0").contains("a STEP above 0"));
        assert!(error("psi=2:1:1").contains("FROM <= TO"));
        assert!(error("gamma=1").contains("expected psi=, theta= or phi="));
        assert!(error("psi=x").contains("\"x\" is not a number"));
        assert!(error("psi=0:89:0.01 theta=-89:89:0.01").contains("at most"));
        assert!(error("psi=0:89:1e-300").contains("a STEP above 0"));
    }
}
