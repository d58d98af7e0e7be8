//! Sizes in some places: on surfaces, in regions, in boxes, and around surfaces and boxes.
use super::parts::{Found, Part};
use crate::cli::walls::Places;
use crate::mesh::TetMesh;
use crate::mesh::vector::Vec3;
use crate::metric::Sym3;
use crate::metric::multiscale::diameter;
use crate::sizing::around::{Cuboid, from_faces, grown};
use crate::tasks::Team;
use std::str::FromStr;

/// How a local size is written.
const USAGE: &str =
    "write 3:h=0.01, inlet:h=0.02, region:2:h=0.05 or box:X0,Y0,Z0,X1,Y1,Z1:h=0.1, and growth=1.2 behind it";

/// Local sizes, with commas between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Locals(Vec<Local>);

/// A greatest size in a place.
#[derive(Clone, Debug, PartialEq)]
struct Local {
    place: Place,
    /// In model units.
    size: f64,
    /// Ratio of the sizes of an edge and the one before, on the way from the place; none where nothing is asked for around it.
    growth: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
enum Place {
    Part(Part),
    Box(Cuboid),
}

impl FromStr for Locals {
    type Err = String;

    /// `3:h=0.01,growth=1.2,box:0,0,0,1,1,1:h=0.1`: a local size ends with its `:h=`, or with the `growth=` behind it.
    fn from_str(text: &str) -> Result<Self, String> {
        let (mut locals, mut begun): (Vec<Local>, Option<String>) = (Vec::new(), None);
        for piece in text.split(',') {
            if let (None, Some(growth)) = (&begun, piece.trim().strip_prefix("growth=")) {
                let last = locals.last_mut().filter(|local| local.growth.is_none());
                let last = last.ok_or_else(|| format!("`{piece}` belongs to no size: {USAGE}"))?;
                last.growth = Some(crate::cli::metric::common::growth(growth)?);
                continue;
            }
            let all = begun.take().map_or_else(|| piece.to_owned(), |begun| format!("{begun},{piece}"));
            match all.rsplit_once(":h=") {
                Some((place, size)) => {
                    locals.push(Local { place: place.parse()?, size: crate::cli::positive(size)?, growth: None });
                }
                None => begun = Some(all),
            }
        }
        begun.map_or(Ok(Self(locals)), |rest| Err(format!("`{rest}`: {USAGE}")))
    }
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some(corners) = text.trim().strip_prefix("box:") else { return text.parse().map(Self::Part) };
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        let numbers: Option<Vec<f64>> = corners.split(',').map(number).collect();
        match numbers.as_deref() {
            Some(&[a, b, c, d, e, f]) => Ok(Self::Box(Cuboid::between([a, b, c], [d, e, f]))),
            _ => Err(format!("`{text}`: a box is two opposite corners, six numbers: box:X0,Y0,Z0,X1,Y1,Z1:h=0.1")),
        }
    }
}

/// Bounds the sizes of ln M at the vertices by those of all places.
pub fn apply(team: Team<'_>, locals: &[Locals], on: &Places<'_>, logs: &mut [Sym3]) -> Result<(), String> {
    for local in locals.iter().flat_map(|locals| &locals.0) {
        let bound = |logs: &mut [Sym3], v: usize, h: f64| {
            logs[v] = logs[v].intersect_logs(&Sym3::ZERO.plus_identity(-2.0 * h.ln()));
        };
        for (v, distance) in local.distances(team, on)?.into_iter().enumerate() {
            match local.growth {
                _ if distance == 0.0 => bound(logs, v, local.size),
                Some(growth) if distance.is_finite() => bound(logs, v, grown(local.size, growth, distance)),
                _ => {}
            }
        }
    }
    Ok(())
}

impl Local {
    /// The distance of each vertex from the place, as far as it matters; 0 on it.
    fn distances(&self, team: Team<'_>, on: &Places<'_>) -> Result<Vec<f64>, String> {
        match &self.place {
            Place::Box(cuboid) => cuboid.distances(team, on.mesh).ok_or_else(|| beside(on.mesh)),
            Place::Part(part) => {
                let found = part.find(on.mesh, on.names)?;
                let mut distances = match self.growth {
                    Some(growth) => {
                        // Larger sizes than the mesh ask for nothing.
                        let within = (diameter(team, on.mesh) - self.size) / (growth - 1.0);
                        from_faces(team, on.mesh, on.model, &faces(&found, on)?, within)
                    }
                    None => vec![f64::INFINITY; on.mesh.vertices.len()],
                };
                for v in found.into_iter().flat_map(|found| found.vertices(on.mesh)) {
                    distances[v as usize] = 0.0;
                }
                Ok(distances)
            }
        }
    }
}

/// The faces of the model under surfaces of the mesh.
fn faces(found: &[Found], on: &Places<'_>) -> Result<Vec<u32>, String> {
    let surface = |found: &Found| match *found {
        Found::Surface(reference) => Ok(reference),
        Found::Region(_) => {
            Err("--local: a size grows around a surface or a box; of a region leave the growth out".to_owned())
        }
    };
    Ok(on.faces(&found.iter().map(surface).collect::<Result<Vec<i32>, _>>()?))
}

/// The error about a box that meets nothing.
fn beside(mesh: &TetMesh) -> String {
    let corner = |f: fn(f64, f64) -> f64| -> Vec3 {
        mesh.vertices.iter().copied().reduce(|a, b| std::array::from_fn(|i| f(a[i], b[i]))).unwrap_or_default()
    };
    let [low, high] = [corner(f64::min), corner(f64::max)].map(crate::cli::table::place);
    format!("--local: a box lies beside the mesh, which reaches from {low} to {high}; give corners in the mesh's units")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Local>, String> {
        text.parse::<Locals>().map(|locals| locals.0)
    }

    #[test]
    fn commas_within_a_box_and_before_a_growth_are_no_ends() {
        let found = read("3:h=0.01,growth=1.2,box:0,0,0,1,-1,1:h=0.1,region:2:h=1").unwrap();
        let [first, second, third] = &found[..] else { panic!("{found:?}") };
        assert_eq!((&first.place, first.size, first.growth), (&Place::Part("3".parse().unwrap()), 0.01, Some(1.2)));
        let cuboid = Cuboid::between([0.0, -1.0, 0.0], [1.0, 0.0, 1.0]);
        assert_eq!((&second.place, second.size, second.growth), (&Place::Box(cuboid), 0.1, None));
        assert_eq!((&third.place, third.growth), (&Place::Part("region:2".parse().unwrap()), None));
        // A surface may be called box.
        assert_eq!(read("box:h=2").unwrap()[0].place, Place::Part("box".parse().unwrap()));
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, part) in [
            ("3", "`3`: write 3:h=0.01"),
            ("3:h=0.1,", "``: write"),
            ("growth=1.2,3:h=1", "belongs to no size"),
            ("3:h=1,growth=1.2,growth=1.3", "belongs to no size"),
            ("3:h=1,growth=0.9", "above 1"),
            ("3:h=-1", "positive"),
            ("box:0,0,0,1,1:h=0.1", "six numbers"),
            ("box:0,0,0,1,1,nan:h=0.1", "six numbers"),
        ] {
            let message = read(text).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
