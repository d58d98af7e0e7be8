//! Walls as words: `wing:h=1e-6,growth=1.2`, `wing:yplus=1,re=6e6,length=1`.
use super::growth::Growth;
use super::spalding::viscous_length;
use serde::Serialize;
use std::str::FromStr;

/// How a wall is written.
const USAGE: &str = "write wing:h=1e-6,growth=1.2 or wing:yplus=1,re=6e6,length=1, and behind it what else is to hold: growth=, tangential=, chord=, law=";

/// Growth of the layers where none is given.
const USUAL_GROWTH: f64 = 1.2;
/// Share of √(8 h R) where none is given ([`crate::sizing::chords::SHARE`]).
const USUAL_CHORD: f64 = crate::sizing::chords::SHARE;

/// Walls, with commas between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Walls(pub Vec<Wall>);

/// A wall, and what its layers are to be like.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Wall {
    /// The surface, by name or reference.
    pub place: String,
    /// Layers that are prescribed.
    pub growth: Option<Growth>,
    /// The height of y⁺ = 1, model units, where sizes are to follow Spalding's law.
    pub spalding: Option<f64>,
}

impl Walls {
    /// The same with layers so many times as thick at the walls, where they are prescribed.
    pub fn thicker(&self, factor: f64) -> Self {
        let each = self.0.iter().cloned();
        Self(each.map(|wall| Wall { growth: wall.growth.map(|growth| growth.thicker(factor)), ..wall }).collect())
    }
}

impl FromStr for Walls {
    type Err = String;

    /// A wall begins with its name and a colon: `wing:h=1e-6,growth=1.2,7:h=1e-5`.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut begun: Vec<Words> = Vec::new();
        for piece in text.split(',').map(str::trim) {
            let Some((key, value)) = piece.rsplit_once('=') else { return Err(format!("`{piece}`: {USAGE}")) };
            let key = match (key.rsplit_once(':'), begun.is_empty()) {
                (Some((place, key)), _) if !place.trim().is_empty() => {
                    begun.push(Words { place: place.trim().into(), ..Words::default() });
                    key
                }
                (None, false) => key,
                _ => return Err(format!("`{piece}` belongs to no wall: {USAGE}")),
            };
            if let Some(words) = begun.last_mut() {
                words.set(key.trim(), value.trim())?;
            }
        }
        begun.into_iter().map(Words::wall).collect::<Result<_, _>>().map(Self)
    }
}

/// What is said of a wall.
#[derive(Default)]
struct Words {
    place: String,
    first: Option<f64>,
    growth: Option<f64>,
    y_plus: Option<f64>,
    reynolds: Option<f64>,
    length: Option<f64>,
    tangential: Option<f64>,
    /// The share, none when off.
    chord: Option<Option<f64>>,
    spalding: Option<bool>,
}

impl Words {
    fn set(&mut self, key: &str, value: &str) -> Result<(), String> {
        let place = &self.place;
        let named = |why: &str| format!("{place}: {key}={value}: {why}");
        let number = || value.parse::<f64>().ok().filter(|x| x.is_finite() && *x > 0.0);
        let positive = || number().ok_or_else(|| named("give a positive number"));
        if key == "chord" {
            let share = match value {
                "off" => None,
                _ => Some(
                    number()
                        .filter(|&x| x <= 1.0)
                        .ok_or_else(|| named("give a share of √(8 h R) above 0 and up to 1, or off"))?,
                ),
            };
            return once(&mut self.chord, share).map_err(|why| named(&why));
        }
        if key == "law" {
            let law = match value {
                "growth" => false,
                "spalding" => true,
                _ => return Err(named("there are law=growth and law=spalding")),
            };
            return once(&mut self.spalding, law).map_err(|why| named(&why));
        }
        let to = match key {
            "h" => &mut self.first,
            "growth" => &mut self.growth,
            "yplus" => &mut self.y_plus,
            "re" => &mut self.reynolds,
            "length" => &mut self.length,
            "tangential" => &mut self.tangential,
            _ => {
                return Err(named("there are h, growth, yplus, re, length, tangential, chord and law"));
            }
        };
        let value = match key {
            "growth" => number().filter(|&x| x > 1.0).ok_or_else(|| {
                named("give a number above 1, such as 1.2: the ratio of the heights of a layer and the one below it")
            })?,
            _ => positive()?,
        };
        once(to, value).map_err(|why| named(&why))
    }

    fn wall(self) -> Result<Wall, String> {
        let Self { place, first, growth, y_plus, reynolds, length, tangential, chord, spalding } = self;
        let is_spalding = spalding == Some(true);
        let refused = |why: &str| Err(format!("{place}: {why}"));
        let unit = match (first, reynolds) {
            (Some(_), Some(_)) => return refused("h and re are both given: give the first height, or yplus with re"),
            (None, None) if y_plus.is_some() => {
                return refused("yplus needs the Reynolds number of a length: re=6e6,length=1");
            }
            (None, None) => return refused("give h, the first height, or yplus with re and length"),
            (Some(_), None) if length.is_some() => return refused("length belongs to re, which is not given"),
            (Some(_), None) if y_plus.is_some() && !is_spalding => {
                return refused("h and yplus are both given: give the first height, or yplus with re");
            }
            (Some(first), None) => first / y_plus.unwrap_or(1.0),
            (None, Some(reynolds)) => viscous_length(reynolds, length.unwrap_or(1.0)),
        };
        let first = unit * y_plus.unwrap_or(1.0);
        let is_prescribed = !is_spalding || growth.is_some();
        if !is_prescribed && (tangential.is_some() || chord.is_some()) {
            return refused("tangential and chord belong to growth: with law=spalding alone the law has all sizes");
        }
        let growth = is_prescribed.then(|| Growth {
            first,
            growth: growth.unwrap_or(USUAL_GROWTH),
            tangential,
            chord: chord.unwrap_or(Some(USUAL_CHORD)),
        });
        Ok(Wall { place, growth, spalding: is_spalding.then_some(unit) })
    }
}

/// Takes a value that is given once.
fn once<T>(to: &mut Option<T>, value: T) -> Result<(), String> {
    match to.replace(value) {
        None => Ok(()),
        Some(_) => Err("is given twice".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Wall>, String> {
        text.parse::<Walls>().map(|walls| walls.0)
    }

    #[test]
    fn walls_by_height_and_by_y_plus() {
        let found = read("wing:h=1e-6,growth=1.3,surface:7:yplus=2,re=6e6,length=3,chord=off,tangential=0.01").unwrap();
        let [first, second] = &found[..] else { panic!("{found:?}") };
        assert_eq!((first.place.as_str(), first.spalding), ("wing", None));
        let growth = Growth { first: 1e-6, growth: 1.3, tangential: None, chord: Some(0.5) };
        assert_eq!(first.growth, Some(growth));
        assert_eq!((second.place.as_str(), second.spalding), ("surface:7", None));
        let found = second.growth.unwrap();
        assert!((found.first / (2.0 * 3.0 * 4.456_878e-6) - 1.0).abs() < 1e-6, "{found:?}");
        assert_eq!((found.growth, found.tangential, found.chord), (1.2, Some(0.01), None));
    }

    #[test]
    fn spaldings_law_has_a_unit_and_a_growth_only_where_one_is_given() {
        let alone = &read("wing:yplus=1,re=6e6,length=1,law=spalding").unwrap()[0];
        assert!(alone.growth.is_none() && (alone.spalding.unwrap() / 4.456_878e-6 - 1.0).abs() < 1e-6);
        let both = &read("wing:law=spalding,h=2e-6,yplus=0.5,growth=1.2").unwrap()[0];
        assert_eq!((both.spalding, both.growth.unwrap().first), (Some(4e-6), 2e-6));
    }

    #[test]
    fn names_may_have_signs_in_them() {
        let found = read("z=0:h=1e-3,growth=1.5,a:b=c:h=1").unwrap();
        assert_eq!(found.iter().map(|wall| wall.place.as_str()).collect::<Vec<_>>(), ["z=0", "a:b=c"]);
        assert_eq!(found[0].growth.unwrap().growth, 1.5);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, part) in [
            ("wing", "`wing`: write wing:h=1e-6"),
            ("", "write wing:h="),
            ("h=1e-6", "belongs to no wall"),
            (":h=1e-6", "belongs to no wall"),
            ("wing:h=0", "wing: h=0: give a positive number"),
            ("wing:h=-1", "positive"),
            ("wing:h=nan", "positive"),
            ("wing:h=1e-6,growth=1", "wing: growth=1: give a number above 1"),
            ("wing:h=1e-6,h=2e-6", "given twice"),
            ("wing:growth=1.2", "give h, the first height, or yplus with re and length"),
            ("wing:yplus=1", "yplus needs the Reynolds number"),
            ("wing:h=1,re=1e6", "both given"),
            ("wing:h=1,yplus=1", "both given"),
            ("wing:h=1,length=1", "length belongs to re"),
            ("wing:h=1,chord=2", "up to 1, or off"),
            ("wing:h=1,law=log", "law=growth and law=spalding"),
            ("wing:re=1e6,law=spalding,chord=off", "belong to growth"),
            ("wing:h=1,size=2", "there are h, growth"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
