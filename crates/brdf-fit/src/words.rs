//! How counts and angles are written in messages, tables and files.

/// `1 reading`, `3 readings`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

/// Degrees of an angle in radians, rounded so that what was written in degrees comes back.
pub(crate) fn in_degrees(radians: f64) -> f64 {
    (radians.to_degrees() * 1e9).round() / 1e9
}

/// Serialises an angle in radians as degrees: in files, angles are in degrees.
pub(crate) mod as_degrees {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
    pub(crate) fn serialize<S: Serializer>(radians: &f64, to: S) -> Result<S::Ok, S::Error> {
        super::in_degrees(*radians).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        f64::deserialize(from).map(f64::to_radians)
    }
}

/// [`as_degrees`] of an angle that need not be there.
pub(crate) mod as_optional_degrees {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(clippy::ref_option, reason = "serde's signature")]
    pub(crate) fn serialize<S: Serializer>(
        radians: &Option<f64>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        radians.map(super::in_degrees).serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
        Ok(Option::<f64>::deserialize(from)?.map(f64::to_radians))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_their_plural() {
        assert_eq!(counted(1, "reading"), "1 reading");
        assert_eq!(counted(0, "reading"), "0 readings");
    }

    #[test]
    fn angles_come_back_as_they_were_written() {
        for degrees in [0.1_f64, 41.4, 63.256_3, 89.999] {
            assert_eq!(in_degrees(degrees.to_radians()), degrees);
        }
    }
}
