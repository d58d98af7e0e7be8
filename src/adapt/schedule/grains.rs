//! How many items a task has, by kind of operation.
use super::work::{KINDS, Kind};
use serde::{Serialize, Serializer};
use std::str::FromStr;

/// Items a task of the speculative scheduler, by kind of operation. `geo-adapt tune` measures them.
///
/// The parts of the deterministic scheduler follow from the mesh and the items alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grains([usize; KINDS]);

impl Grains {
    /// The same for all kinds.
    pub fn uniform(grain: usize) -> Self {
        Self([grain; KINDS])
    }

    /// That of one kind.
    pub fn of(&self, kind: Kind) -> usize {
        self.0[kind as usize]
    }

    /// Sets that of one kind.
    pub fn set(&mut self, kind: Kind, grain: usize) {
        self.0[kind as usize] = grain;
    }
}

impl Default for Grains {
    /// Measured on two threads: smaller ones cost claims and cold caches, whatever the back-end (docs/decisions/tasks.md has the table).
    fn default() -> Self {
        Self::uniform(512)
    }
}

impl std::fmt::Display for Grains {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, kind) in Kind::ALL.into_iter().enumerate() {
            write!(f, "{}{}={}", if i == 0 { "" } else { "," }, kind.name(), self.of(kind))?;
        }
        Ok(())
    }
}

impl FromStr for Grains {
    type Err = String;

    /// `64` for all kinds, or some of them: `insertion=128,smoothing=64`.
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| match text.trim().parse() {
            Ok(grain) if grain > 0 => Ok(grain),
            _ => Err(format!("`{text}` is no number of items, from 1 on")),
        };
        if !text.contains('=') {
            return number(text).map(Self::uniform);
        }
        let mut grains = Self::default();
        for part in text.split(',') {
            let (name, grain) = part.split_once('=').ok_or_else(|| format!("`{part}`: write operation=items"))?;
            let kind = Kind::ALL.into_iter().find(|kind| kind.name() == name.trim()).ok_or_else(|| {
                format!("there is no operation `{name}`; there are {}", Kind::ALL.map(Kind::name).join(", "))
            })?;
            grains.set(kind, number(grain)?);
        }
        Ok(grains)
    }
}

impl Serialize for Grains {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(Kind::ALL.into_iter().map(|kind| (kind.name(), self.of(kind))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_is_read() {
        let mut grains = Grains::uniform(7);
        grains.set(Kind::Smooth, 300);
        assert_eq!(grains.to_string().parse(), Ok(grains));
        assert_eq!("12".parse(), Ok(Grains::uniform(12)));
        let some: Grains = "reconnection=9, smoothing=8".parse().expect("two of them");
        assert_eq!([Kind::Reconnect, Kind::Smooth, Kind::Split].map(|kind| some.of(kind)), [9, 8, 512]);
        for wrong in ["", "0", "smoothing=0", "swapping=3", "smoothing=3,4", "smoothing=-1"] {
            assert!(wrong.parse::<Grains>().is_err(), "{wrong}");
        }
    }
}
