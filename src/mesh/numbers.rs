//! Numbers in JSON: entities count from 1 there, as in files and messages; in memory they count from 0.
use serde::{Serialize, Serializer};

/// An index from 0, or several.
pub trait Index {
    /// What is written of it.
    type Number: Serialize;

    /// The same, from 1.
    fn number(&self) -> Self::Number;
}

impl Index for u32 {
    type Number = u64;

    fn number(&self) -> u64 {
        u64::from(*self) + 1
    }
}

impl Index for usize {
    type Number = u64;

    fn number(&self) -> u64 {
        *self as u64 + 1
    }
}

impl<T: Index> Index for Option<T> {
    type Number = Option<T::Number>;

    fn number(&self) -> Self::Number {
        self.as_ref().map(T::number)
    }
}

impl<T: Index> Index for Vec<T> {
    type Number = Vec<T::Number>;

    fn number(&self) -> Self::Number {
        self.iter().map(T::number).collect()
    }
}

impl<T: Index, const N: usize> Index for [T; N] {
    type Number = Vec<T::Number>;

    fn number(&self) -> Self::Number {
        self.iter().map(T::number).collect()
    }
}

/// Writes indices from 0 as numbers from 1: for `#[serde(serialize_with = "from_one")]`.
///
/// # Errors
/// As the serializer has them.
pub fn from_one<S: Serializer>(index: &impl Index, to: S) -> Result<S::Ok, S::Error> {
    index.number().serialize(to)
}
