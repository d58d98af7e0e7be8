//! Three numbers to move something by.
use std::str::FromStr;

/// A translation. (A type of its own, since clap would take an array for several arguments.)
#[derive(Clone, Copy, Default)]
pub struct Translation(pub [f64; 3]);

impl FromStr for Translation {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<f64> = text.split(',').filter_map(|word| word.trim().parse().ok()).collect();
        match words[..] {
            [x, y, z] if text.split(',').count() == 3 && [x, y, z].iter().all(|x| x.is_finite()) => Ok(Self([x, y, z])),
            _ => Err("give three numbers: 0,0,1.5".into()),
        }
    }
}
