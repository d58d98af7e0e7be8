//! Values of a solution at points, as functionals.
use super::config::Probe;
use super::data::{FieldName, Solved};
use super::field_value::Value;
use crate::mesh::TetMesh;
use crate::mesh::locate::Locator;
use crate::mesh::vector::distance;
use crate::tasks::Team;
use crate::transfer::{Places, interpolate};
use std::collections::BTreeMap;

/// A point farther from the mesh than this part of the diagonal of its box is outside; a curved wall may leave some out.
const NEAR: f64 = 1e-3;

/// Adds the values at the probes to the functionals of a solution.
///
/// # Errors
/// When a point is outside the mesh, a field is not there, or the solver tells a functional of the same name.
pub fn add(probes: &BTreeMap<String, Probe>, mesh: &TetMesh, solved: &mut Solved) -> Result<(), String> {
    if probes.is_empty() {
        return Ok(());
    }
    let corner = |f: fn(f64, f64) -> f64| {
        mesh.vertices.iter().copied().reduce(|a, b| std::array::from_fn(|i| f(a[i], b[i]))).unwrap_or_default()
    };
    let near = NEAR * distance(corner(f64::min), corner(f64::max));
    let locator = Locator::new(mesh.vertices.clone(), mesh.tets.nodes.clone());
    let names: Vec<FieldName> = solved.fields.iter().map(FieldName::of).collect();
    for (name, probe) in probes {
        let named = |error: String| format!("[probes] {name}: {error}");
        let value = Value::find(&probe.field, &names).map_err(named)?;
        let places = Places::of(Team::alone(), &locator, &[probe.at]);
        if places.farthest > near {
            let [x, y, z] = probe.at;
            return Err(named(format!("({x}, {y}, {z}) is {:.3e} outside the mesh", places.farthest)));
        }
        let fields = solved.fields.iter();
        let at = |values, width| interpolate(Team::alone(), &locator, &places, width, values);
        let all: Vec<f64> = fields.flat_map(|field| at(&field.values, field.kind.values())).collect();
        if solved.functionals.insert(name.clone(), value.of(&all)).is_some() {
            return Err(named("the solver tells a functional of this name too: call the probe something else".into()));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::NamedField;
    use crate::mesh::io::FieldKind;
    use crate::mesh::samples::cube;

    #[test]
    fn a_probe_is_the_value_there() {
        let mesh = cube(3);
        let vector = mesh.vertices.iter().flat_map(|p| [3.0 * p[0], 4.0 * p[0], 0.0]).collect();
        let scalar = mesh.vertices.iter().map(|p| p[2]).collect();
        let mut solved = Solved {
            fields: vec![
                NamedField { name: "U".into(), kind: FieldKind::Vector, values: vector },
                NamedField { name: "p".into(), kind: FieldKind::Scalar, values: scalar },
            ],
            functionals: BTreeMap::from([("drag".into(), 1.0)]),
        };
        let probe = |field: &str, at| Probe { field: field.into(), at };
        let probes = BTreeMap::from([
            ("speed".to_owned(), probe("U:norm", [0.2, 0.5, 0.5])),
            ("there".to_owned(), probe("p", [0.2, 0.5, 0.55])),
        ]);
        add(&probes, &mesh, &mut solved).unwrap();
        assert!(
            (solved.functionals["speed"] - 1.0).abs() < 1e-12 && (solved.functionals["there"] - 0.55).abs() < 1e-12
        );
        let mut refused = |name: &str, field, at| {
            add(&BTreeMap::from([(name.to_owned(), probe(field, at))]), &mesh, &mut solved).unwrap_err()
        };
        assert!(refused("far", "p", [2.0, 0.5, 0.5]).contains("[probes] far: (2, 0.5, 0.5) is 1.000e0 outside"));
        assert!(refused("none", "q", [0.5; 3]).contains("there are U, p"));
        assert!(refused("drag", "p", [0.5; 3]).contains("of this name too"));
    }
}
