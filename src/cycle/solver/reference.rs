//! Reference area and length of coefficients, of the walls of a mesh: the planform and its mean aerodynamic chord.
use crate::geometry::Names;
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, area2};

/// Sections across the span.
const SECTIONS: usize = 1000;

/// A planform smaller than this part of the square of the walls' extent is none.
const LEAST: f64 = 1e-9;

/// Reference area and length. The flow comes in the x-z plane, so the wing is seen along z, its span is along y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Area of the walls as seen along z, model units²; of half a body that of the half.
    pub area: f64,
    /// Mean aerodynamic chord ∫c² dy / ∫c dy, c the extent of the walls along x at y, model units.
    pub length: f64,
}

impl Reference {
    /// Of the surfaces of these names, or references where they have none. None where they are no body with an area along z.
    pub fn of(mesh: &TetMesh, names: &Names, walls: &[String]) -> Option<Self> {
        let name = |reference: i32| names.triangles.get(&reference).and_then(|label| label.name.as_deref());
        let is_wall = |reference: i32| {
            let number = reference.to_string();
            walls.iter().any(|wall| Some(wall.as_str()) == name(reference) || *wall == number)
        };
        let chosen = mesh.triangles.iter().filter(|&(_, reference)| is_wall(reference));
        let triangles: Vec<[Vec3; 3]> = chosen.map(|(nodes, _)| nodes.map(|v| mesh.vertices[v as usize])).collect();
        // A ray along z meets a closed surface twice.
        let area = triangles.iter().map(|&[a, b, c]| 0.25 * area2(a, b, c)[2].abs()).sum::<f64>();
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in triangles.iter().flatten() {
            low = std::array::from_fn(|i| low[i].min(p[i]));
            high = std::array::from_fn(|i| high[i].max(p[i]));
        }
        let extent = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
        if area <= LEAST * extent * extent {
            return None;
        }
        let chords = chords(&triangles, low[1], high[1]);
        let of_power = |power: i32| chords.iter().map(|chord| chord.powi(power)).sum::<f64>();
        Some(Self { area, length: of_power(2) / of_power(1) })
    }
}

/// The extents along x at sections from y = low to y = high.
fn chords(triangles: &[[Vec3; 3]], low: f64, high: f64) -> Vec<f64> {
    let step = (high - low) / SECTIONS as f64;
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; SECTIONS];
    for triangle in triangles {
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let (mut p, mut q) = (triangle[from], triangle[to]);
            if p[1] > q[1] {
                std::mem::swap(&mut p, &mut q);
            }
            let first = ((p[1] - low) / step - 0.5).ceil().max(0.0) as usize;
            for (section, range) in ranges.iter_mut().enumerate().skip(first) {
                let y = low + (section as f64 + 0.5) * step;
                if y > q[1] {
                    break;
                }
                let share = if q[1] > p[1] { (y - p[1]) / (q[1] - p[1]) } else { 0.0 };
                let x = p[0] + share * (q[0] - p[0]);
                *range = [range[0].min(x), range[1].max(x)];
            }
        }
    }
    ranges.into_iter().map(|[low, high]| (high - low).max(0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Label;
    use crate::mesh::samples::cube;

    #[test]
    fn a_block_has_its_floor_and_its_depth() {
        let mut mesh = cube(3);
        crate::geometry::discrete::complete_boundary(crate::tasks::Team::alone(), &mut mesh);
        mesh.vertices.iter_mut().for_each(|p| *p = [2.0 * p[0], 5.0 * p[1], 0.5 * p[2]]);
        mesh.triangles.refs.iter_mut().for_each(|reference| *reference = 4);
        let mut names = Names::default();
        let of = |names: &Names, wall: &str| Reference::of(&mesh, names, &[wall.into()]);
        let found = of(&names, "4").unwrap();
        assert!((found.area - 10.0).abs() < 1e-12 && (found.length - 2.0).abs() < 1e-12, "{found:?}");
        assert_eq!(of(&names, "wing"), None);
        names.triangles.insert(4, Label { name: Some("wing".into()), colour: None });
        assert_eq!(of(&names, "wing"), Some(found));
    }

    #[test]
    fn a_triangular_wing_has_two_thirds_of_its_root_chord() {
        // Two sides of a delta, root chord 1 at y = 0, tip at y = 2.
        let mesh = TetMesh {
            vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]],
            triangles: crate::mesh::Elements { nodes: vec![[0, 1, 2], [0, 2, 1]], refs: vec![1, 1] },
            ..TetMesh::default()
        };
        let found = Reference::of(&mesh, &Names::default(), &["1".into()]).unwrap();
        assert!((found.area - 1.0).abs() < 1e-12 && (found.length - 2.0 / 3.0).abs() < 1e-5, "{found:?}");
        let upright = TetMesh { vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 2.0]], ..mesh };
        assert_eq!(Reference::of(&upright, &Names::default(), &["1".into()]), None);
    }
}
