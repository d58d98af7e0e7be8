//! Names that the command line gives to faces.
use crate::geometry::{Evaluate, Geometry, Model, Names};
use crate::mesh::vector::Vec3;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::str::FromStr;

/// A name and its faces.
#[derive(Clone)]
pub struct Naming {
    name: String,
    faces: Faces,
}

#[derive(Clone)]
enum Faces {
    /// By number, from 1.
    Numbers(Vec<u32>),
    /// The one nearest to a point.
    Near(Vec3),
}

impl FromStr for Naming {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong =
            || "give a name and its faces: inlet=3,7, or the face nearest to a point: wall=near:0,0,1".to_string();
        let (name, faces) = text.rsplit_once('=').ok_or_else(wrong)?;
        let name = name.trim();
        if name.is_empty() {
            return Err(wrong());
        }
        let faces = if let Some(point) = faces.strip_prefix("near:") {
            let point: Vec<f64> =
                point.split(',').map(|x| x.trim().parse()).collect::<Result<_, _>>().map_err(|_| wrong())?;
            let point = Vec3::try_from(point).ok().filter(|point| point.iter().all(|x| x.is_finite()));
            Faces::Near(point.ok_or_else(wrong)?)
        } else {
            let numbers: Vec<u32> =
                faces.split(',').map(|number| number.trim().parse()).collect::<Result<_, _>>().map_err(|_| wrong())?;
            Faces::Numbers(numbers)
        };
        Ok(Self { name: name.into(), faces })
    }
}

/// The name of each face that is given one, by its number.
///
/// # Errors
/// For a face that is not there, one of two names, and a point that is no nearer to one face than to another.
pub fn faces(model: &Model, namings: &[Naming]) -> Result<BTreeMap<i32, String>, String> {
    let count = model.topology().faces.len();
    let mut found = BTreeMap::new();
    for Naming { name, faces } in namings {
        let numbers = match faces {
            Faces::Numbers(numbers) => numbers.clone(),
            Faces::Near(point) => vec![nearest(model, *point).map_err(|error| format!("--name {name}: {error}"))?],
        };
        for number in numbers {
            if number == 0 || number as usize > count {
                return Err(format!(
                    "--name {name}: there is no face {number}; the faces are 1 to {count}, as geo-adapt model lists them"
                ));
            }
            if let Some(other) = found.insert(number as i32, name.clone()).filter(|other| other != name) {
                return Err(format!("--name: face {number} would be {other} and {name}; give it one name"));
            }
        }
    }
    Ok(found)
}

/// The number of the face nearest to a point.
fn nearest(model: &Model, point: Vec3) -> Result<u32, String> {
    let mut on = model.evaluator();
    let faces = 0..model.topology().faces.len() as u32;
    let mut all: Vec<(f64, u32)> =
        faces.map(|face| (on.closest_on_face(face, point, None).distance, face + 1)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(least, number)) = all.first() else { return Err("there are no faces".into()) };
    let same = model.topology().tolerance + 1e-9 * model.topology().diagonal();
    match all.get(1) {
        Some(&(next, other)) if next - least <= same => {
            Err(format!("faces {number} and {other} are equally near to that point; give a point inside one of them"))
        }
        _ => Ok(number),
    }
}

/// Adds the names, each face keeping its colour.
pub fn name(names: &mut Names, found: &BTreeMap<i32, String>) {
    for (&number, name) in found {
        names.triangles.entry(number).or_default().name = Some(name.clone());
    }
}

/// A line for each name.
pub fn describe(found: &BTreeMap<i32, String>) -> String {
    let mut by_name: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    found.iter().for_each(|(number, name)| by_name.entry(name).or_default().push(number.to_string()));
    let mut text = String::new();
    for (name, numbers) in by_name {
        let what = if numbers.len() == 1 { "face" } else { "faces" };
        let _ = writeln!(text, "{name}: {what} {}", numbers.join(" "));
    }
    text
}
