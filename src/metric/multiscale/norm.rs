//! The norm of the interpolation error that a metric makes small.
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;

/// The exponent p of an L^p norm: 1 to infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Norm(f64);

impl Norm {
    /// L¹.
    pub const ONE: Self = Self(1.0);
    /// The greatest error.
    pub const MOST: Self = Self(f64::INFINITY);

    /// Of an exponent p ≥ 1, infinity among them.
    pub fn of(p: f64) -> Option<Self> {
        (p >= 1.0).then_some(Self(p))
    }

    /// p, infinity for the greatest error.
    pub fn exponent(self) -> f64 {
        self.0
    }

    /// 2p + 3, the number that divides in all exponents of three dimensions; infinite for p = ∞.
    pub(super) fn divisor(self) -> f64 {
        2.0 * self.0 + 3.0
    }
}

impl Default for Norm {
    /// L².
    fn default() -> Self {
        Self(2.0)
    }
}

impl fmt::Display for Norm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl FromStr for Norm {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        text.parse().ok().and_then(Self::of).ok_or_else(|| "give a number from 1 on, such as 1, 2 or 4, or inf".into())
    }
}

impl Serialize for Norm {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // JSON has no infinity.
        if self.0.is_finite() { serializer.serialize_f64(self.0) } else { serializer.serialize_str("inf") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norms_as_text() {
        for (text, p) in [("1", 1.0), ("2", 2.0), ("2.5", 2.5), ("inf", f64::INFINITY)] {
            let norm: Norm = text.parse().unwrap();
            assert_eq!(norm, Norm(p));
            assert_eq!(norm.to_string(), text);
        }
        for text in ["0", "0.9", "-inf", "NaN", "two", ""] {
            assert!(text.parse::<Norm>().is_err(), "{text}");
        }
        assert_eq!(serde_json::to_string(&[Norm::MOST, Norm::default()]).unwrap(), "[\"inf\",2.0]");
    }
}
