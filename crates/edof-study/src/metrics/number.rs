//! Numbers of rows that JSON has no form for: PSNR of equal pictures is infinite, and a method may give what is NaN. Written as
//! the words `inf`, `-inf` and `nan`, so that what is written is read back: `#[serde(with = "crate::metrics::number")]`.

use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// # Errors
/// Those of the format.
pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
    Number(*value).serialize(to)
}

/// # Errors
/// Those of the format; anything but a number or one of the three words.
pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Number::deserialize(from)?.0)
}

/// The same for a number of each colour.
pub mod colours {
    use super::Number;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// # Errors
    /// Those of the format.
    pub fn serialize<S: Serializer>(values: &[f64; 3], to: S) -> Result<S::Ok, S::Error> {
        values.map(Number).serialize(to)
    }

    /// # Errors
    /// As for one number, or not three of them.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 3], D::Error> {
        Ok(<[Number; 3]>::deserialize(from)?.map(|number| number.0))
    }
}

/// The same for pairs, such as depths and decibels.
pub mod pairs {
    use super::Number;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// # Errors
    /// Those of the format.
    pub fn serialize<S: Serializer>(pairs: &[[f64; 2]], to: S) -> Result<S::Ok, S::Error> {
        pairs.iter().map(|pair| pair.map(Number)).collect::<Vec<_>>().serialize(to)
    }

    /// # Errors
    /// As for one number.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<[f64; 2]>, D::Error> {
        let pairs = Vec::<[Number; 2]>::deserialize(from)?;
        Ok(pairs.into_iter().map(|pair| pair.map(|number| number.0)).collect())
    }
}

#[derive(Clone, Copy)]
struct Number(f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            value if value.is_finite() => to.serialize_f64(value),
            value if value.is_nan() => to.serialize_str("nan"),
            value if value > 0.0 => to.serialize_str("inf"),
            _ => to.serialize_str("-inf"),
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Reader;
        impl Visitor<'_> for Reader {
            type Value = Number;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number, \"inf\", \"-inf\" or \"nan\"")
            }

            fn visit_f64<E>(self, value: f64) -> Result<Number, E> {
                Ok(Number(value))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_str<E: Error>(self, word: &str) -> Result<Number, E> {
                match word {
                    "inf" => Ok(Number(f64::INFINITY)),
                    "-inf" => Ok(Number(f64::NEG_INFINITY)),
                    "nan" => Ok(Number(f64::NAN)),
                    other => Err(E::invalid_value(Unexpected::Str(other), &self)),
                }
            }
        }
        from.deserialize_any(Reader)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize, Deserialize)]
    struct Row {
        #[serde(with = "super")]
        db: f64,
        #[serde(with = "super::colours")]
        colours: [f64; 3],
        #[serde(with = "super::pairs")]
        depths: Vec<[f64; 2]>,
    }

    #[test]
    fn every_number_is_read_back_as_it_was_written() {
        for db in [f64::INFINITY, f64::NEG_INFINITY, 3.9634806967355276, -0.0, 3.0] {
            let row = Row { db, colours: [db, 1.0, f64::NAN], depths: vec![[8.0, db]] };
            let text = serde_json::to_string(&row).unwrap();
            let back: Row = serde_json::from_str(&text).unwrap();
            assert_eq!(back.db.to_bits(), db.to_bits(), "{text}");
            assert!(
                back.colours[0] == db && back.colours[2].is_nan() && back.depths == [[8.0, db]],
                "{text}"
            );
        }
        let error = serde_json::from_str::<Row>("{\"db\": \"much\"}").err().unwrap().to_string();
        assert!(error.starts_with("invalid value: string \"much\", expected a number, \"inf\""), "{error}");
    }
}
