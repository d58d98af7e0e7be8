//! What the tests on CAD models share: where the models lie, and random points that repeat from run to run.
use super::shared_case;
use geo_adapt::mesh::vector::{Vec3, distance};
use std::path::{Path, PathBuf};

/// A model of tests/data.
pub fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// Models to measure on: the shared ones where they are there, geometry/ and tests/data.
pub fn models() -> Vec<PathBuf> {
    let shared = [
        "cube-cylinder/cube-cylinder.step",
        "cube-cylinder/cube-cylinder.egads",
        "hemisphere-cylinder/hemisph-cyl.stp",
        "hemisphere-cylinder/hemisph-cyl.egads",
        "onera-m6/onera-m6-sharp-te.stp",
    ];
    let mut all: Vec<_> = shared.iter().filter_map(|name| shared_case(name)).collect();
    for folder in ["geometry", "tests/data"] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        all.extend(entries.filter(|path| {
            path.extension().is_some_and(|kind| ["step", "brep", "igs"].iter().any(|known| kind == *known))
        }));
    }
    all.sort();
    assert!(all.len() >= 7, "the models of tests/data are gone");
    all
}

/// Numbers that repeat from run to run (splitmix64).
pub struct Random(pub u64);

impl Random {
    /// A number in 0..1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number of the range.
    pub fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.next()
    }

    /// A point of the box, grown by a share of its diagonal.
    pub fn within(&mut self, [low, high]: [Vec3; 2], share: f64) -> Vec3 {
        let grown = share * distance(low, high);
        [0, 1, 2].map(|k: usize| self.between([low[k] - grown, high[k] + grown]))
    }
}
