//! `--far-field`: the domain around a body, built by a child process, since OpenCASCADE can crash on a shape that it cannot cut.
use super::solids::check_solids;
use crate::cli::child::{self, Answer, Task};
use crate::cli::load;
use crate::cli::workplace::Workplace;
use crate::geometry::{Evaluate, FaceEntity, FarField, Geometry, Model, SurfaceKind, Topology, names};
use crate::mesh::vector::{Vec3, distance};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

/// First argument of the child; then the body's model, the domain's file, the far field and the axis of symmetry or `-`.
const CHILD: &str = "build-domain-and-exit";

/// How far a plane of symmetry may be from the end of the body's box, of its diagonal.
const FLAT: f64 = 1e-6;

/// The far field, as it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    kind: Kind,
    text: String,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// Least and greatest corner.
    Box([Vec3; 2]),
    /// This many greatest extents of the body on each side of it.
    Around(f64),
    /// Radius; about the middle of the body.
    Sphere(f64),
    /// Centre and radius.
    SphereAt(Vec3, f64),
}

impl FromStr for Spec {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            "write box:XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, or box:FACTOR (so many extents of the body beyond it), sphere:RADIUS, or \
             sphere:X,Y,Z,RADIUS"
                .to_string()
        };
        let (kind, numbers) = text.split_once(':').ok_or_else(wrong)?;
        let numbers: Result<Vec<f64>, _> = numbers.split(',').map(|number| number.trim().parse::<f64>()).collect();
        let numbers = numbers.ok().filter(|numbers| numbers.iter().all(|x| x.is_finite())).ok_or_else(wrong)?;
        let kind = match (kind.trim(), &numbers[..]) {
            ("box", &[a, b, c, d, e, f]) if a < d && b < e && c < f => Kind::Box([[a, b, c], [d, e, f]]),
            ("box", &[_, _, _, _, _, _]) => return Err("the box has no volume: give the least corner first".into()),
            ("box", &[factor]) if factor > 0.0 => Kind::Around(factor),
            ("sphere", &[radius]) if radius > 0.0 => Kind::Sphere(radius),
            ("sphere", &[x, y, z, radius]) if radius > 0.0 => Kind::SphereAt([x, y, z], radius),
            _ => return Err(wrong()),
        };
        Ok(Self { kind, text: text.into() })
    }
}

/// Normal of the plane of symmetry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
#[allow(missing_docs)]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    const ALL: [(Self, &'static str); 3] = [(Self::X, "x"), (Self::Y, "y"), (Self::Z, "z")];
}

/// Builds the domain around `body` and writes it to `file`, with the names of its faces beside. Returns the file.
///
/// # Errors
/// When the body has no solid or no plane side where the symmetry is, reaches beyond the far field, or cannot be subtracted.
pub fn build(body: &Path, spec: &Spec, symmetry: Option<Axis>, file: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let axis = Axis::ALL.iter().find(|(axis, _)| Some(*axis) == symmetry).map_or("-", |(_, name)| name);
    let place = Workplace::new().map_err(|error| format!("no folder for temporary files: {error}"))?;
    let task = Task {
        name: CHILD,
        arguments: &[body.as_os_str(), file.as_os_str(), spec.text.as_ref(), axis.as_ref()],
        file: body,
        doing: "making the far field around it",
        crash: "OpenCASCADE crashes on the subtraction of the body from the far field; repair the body's solid in the CAD program",
    };
    match task.run(&place)? {
        Answer::Done => Ok(file.to_owned()),
        Answer::Refused(told) => Err(told.into()),
        Answer::NotStarted => Err("geo-adapt cannot start itself".into()),
    }
}

/// If this process is the child of [`build`]: builds the domain and tells the exit code.
pub fn child() -> Option<ExitCode> {
    child::answer(CHILD, |arguments| {
        let [body, file, spec, axis] = arguments else {
            return Err("a body, a file, a far field and an axis are wanted".into());
        };
        let [spec, axis] = [spec, axis].map(|word| word.to_string_lossy());
        write(Path::new(body), Path::new(file), &spec, &axis).map_err(|error| error.to_string())
    })
}

fn write(body: &Path, file: &Path, spec: &str, axis: &str) -> Result<(), Box<dyn Error>> {
    let mut model = Model::read(body)?;
    load::give_names(&mut model, body)?;
    check_solids(body, &model)?;
    let symmetry = Axis::ALL.iter().find(|(_, name)| *name == axis).map(|(axis, _)| *axis);
    let named = |error: String| format!("{}: {error}", body.display());
    let far = spec.parse::<Spec>().and_then(|spec| place(&model, &spec.kind, symmetry)).map_err(named)?;
    let domain = model.domain(&far).map_err(|error| named(error.to_string()))?;
    domain.write_brep(file)?;
    Ok(names::write(file, domain.names(), &[])?)
}

/// The far field in numbers.
fn place(model: &Model, kind: &Kind, symmetry: Option<Axis>) -> Result<FarField, String> {
    let topology = model.topology();
    let [low, high] = topology.bounds;
    let symmetry =
        symmetry.map(|axis| plane(model, axis as usize).map(|(at, above)| (axis as usize, at, above))).transpose()?;
    let extent = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let mut middle: Vec3 = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
    if let Some((axis, at, _)) = symmetry {
        middle[axis] = at;
    }
    let sphere = match *kind {
        Kind::Sphere(radius) => Some((middle, radius)),
        Kind::SphereAt(centre, radius) => Some((centre, radius)),
        _ => None,
    };
    let mut bounds = match (kind, sphere) {
        (Kind::Box(bounds), _) => *bounds,
        (Kind::Around(factor), _) => [low.map(|x| x - factor * extent), high.map(|x| x + factor * extent)],
        (_, Some((centre, radius))) => [centre.map(|x| x - 2.0 * radius), centre.map(|x| x + 2.0 * radius)],
        (_, None) => topology.bounds,
    };
    if let Some((axis, at, above)) = symmetry {
        bounds[usize::from(!above)][axis] = at;
    }
    let far = FarField { bounds, sphere, symmetry: symmetry.map(|(axis, at, _)| (axis, at)) };
    if holds(&far, topology, symmetry) { Ok(far) } else { Err(beyond(topology)) }
}

/// Whether the body lies within.
fn holds(far: &FarField, topology: &Topology, symmetry: Option<(usize, f64, bool)>) -> bool {
    let [low, high] = topology.bounds;
    let is_cut = |axis: usize, end: bool| symmetry.is_some_and(|(a, _, above)| a == axis && above != end);
    let in_box = (0..3)
        .all(|i| (is_cut(i, false) || far.bounds[0][i] < low[i]) && (is_cut(i, true) || far.bounds[1][i] > high[i]));
    let corner = |k: usize| -> Vec3 { std::array::from_fn(|i| if k >> i & 1 == 0 { low[i] } else { high[i] }) };
    in_box && far.sphere.is_none_or(|(centre, radius)| (0..8).all(|k| distance(corner(k), centre) < radius))
}

fn beyond(topology: &Topology) -> String {
    let [low, high] = topology.bounds;
    format!(
        "the body's box, {low:?} to {high:?}, reaches beyond the far field; give a larger one, in the model's units"
    )
}

/// Where the plane of symmetry lies on its axis, and whether the body is above it: it is where the body ends in plane faces.
fn plane(model: &Model, axis: usize) -> Result<(f64, bool), String> {
    let topology = model.topology();
    let slack = FLAT * topology.diagonal();
    let at_end = |face: &FaceEntity, end: usize| {
        let there = topology.bounds[end][axis];
        face.kind == SurfaceKind::Plane && face.bounds.iter().all(|corner| (corner[axis] - there).abs() <= slack)
    };
    let mut best: Option<(f64, u32, usize)> = None;
    for end in [0, 1] {
        let faces = || topology.faces.iter().zip(0..).filter(|(face, _)| at_end(face, end)).map(|(_, i)| i);
        let area: f64 = faces().filter_map(|face| model.face_area(face)).sum();
        if let Some(face) = faces().next()
            && best.is_none_or(|(most, ..)| area > most)
        {
            best = Some((area, face, end));
        }
    }
    let name = Axis::ALL[axis].1;
    let (_, face, end) = best.ok_or_else(|| {
        format!("no plane face of the body lies at its least or greatest {name}: --symmetry {name} is for a half of a body, cut there")
    })?;
    let [u, v] = topology.faces[face as usize].range.map(|[a, b]| 0.5 * (a + b));
    Ok((model.evaluator().face_frame(face, [u, v]).point[axis], end == 0))
}

/// Faces of the body in a domain, and the diagonal of the box around them.
pub fn body(model: &Model) -> (Vec<u32>, f64) {
    let names = &model.names().triangles;
    let is_body = |face: u32| {
        let name = names.get(&(face as i32 + 1)).and_then(|label| label.name.as_deref());
        !matches!(name, Some("farfield" | "symmetry"))
    };
    let faces = &model.topology().faces;
    let found: Vec<u32> = (0..faces.len() as u32).filter(|&face| is_body(face)).collect();
    let corner = |k: usize, f: fn(f64, f64) -> f64| {
        let corners = found.iter().map(|&face| faces[face as usize].bounds[k]);
        corners.reduce(|a, b| std::array::from_fn(|i| f(a[i], b[i]))).unwrap_or_default()
    };
    let diagonal = distance(corner(0, f64::min), corner(1, f64::max));
    (found, diagonal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_fields_are_read_or_refused_with_their_forms() {
        let kind = |text: &str| text.parse::<Spec>().map(|spec| spec.kind);
        assert_eq!(kind("box:-1,-2,-3,1,2,3"), Ok(Kind::Box([[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]])));
        assert_eq!(kind("box: 10"), Ok(Kind::Around(10.0)));
        assert_eq!(kind("sphere:5e1"), Ok(Kind::Sphere(50.0)));
        assert_eq!(kind("sphere:0,1,2,3"), Ok(Kind::SphereAt([0.0, 1.0, 2.0], 3.0)));
        for text in ["box", "box:", "box:1,2", "sphere:-1", "ball:3", "box:nan", "sphere:1,2,3", "box:0"] {
            assert!(kind(text).unwrap_err().contains("write box:XMIN"), "{text}");
        }
        assert!(kind("box:1,0,0,0,1,1").unwrap_err().contains("no volume"));
    }
}
