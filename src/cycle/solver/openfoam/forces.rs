//! Forces of the flow on walls, from the values of the cells at them.
use super::cells::Cells;
use super::flow::Flow;
use crate::mesh::adjacency::{FACES, TriangleIndex};
use crate::mesh::vector::{Vec3, add, cross, dot, norm, scale, sub};
use crate::tasks::Team;

/// A triangle of a wall.
struct Piece {
    /// The cell at it.
    cell: u32,
    /// Its area times the normal that points out of the flow, into the body.
    area: Vec3,
    /// The distance of the cell's centroid.
    height: f64,
}

/// The walls of a mesh.
pub struct Walls {
    pieces: Vec<Piece>,
}

impl Walls {
    /// The triangles of these references that lie on one cell.
    pub fn of(cells: &Cells, references: &[i32]) -> Self {
        let (team, mesh, centroids) = (Team::alone(), &cells.mesh, cells.centroids());
        let sides = TriangleIndex::new(team, &mesh.triangles.nodes, mesh.vertices.len()).sides(team, &mesh.tets.nodes);
        let wall = sides.into_iter().filter(|side| references.contains(&mesh.triangles.refs[side.triangle as usize]));
        let piece = |tet: u32, face: u32| {
            let nodes = mesh.tets.nodes[tet as usize];
            let [a, b, c] = FACES[face as usize].map(|i| mesh.vertices[nodes[i] as usize]);
            let area = scale(cross(sub(b, a), sub(c, a)), 0.5);
            let cell = cells.of[tet as usize];
            let height = (dot(sub(centroids[cell as usize], a), area) / norm(area)).abs();
            Piece { cell, area, height }
        };
        Self { pieces: wall.map(|side| piece(side.tet, side.face)).collect() }
    }

    /// Lift and drag coefficients of pressures and velocities of the cells. The pressure is that of the cell at the wall; velocities vary only
    /// with the distance h from the wall, linearly up to the cell's centroid, which leaves of the viscous stress of a Newtonian gas
    /// μ (u + n (n·u) / 3) / h. What goes through the wall there vanishes as the mesh becomes finer, but the solver's momentum has it: without
    /// it the lift of the delta wing was 0.5 % less than what OpenFOAM's own `forces` finds, with 3000 vertices.
    pub fn coefficients(&self, flow: &Flow, pressure: &[f64], velocity: &[f64]) -> Coefficients {
        let mut force = [0.0; 3];
        let viscosity = flow.viscosity();
        for Piece { cell, area, height } in &self.pieces {
            let cell = *cell as usize;
            force = add(force, scale(*area, pressure[cell] - flow.pressure));
            if viscosity > 0.0 {
                let size = norm(*area);
                let normal = scale(*area, 1.0 / size);
                let moving: Vec3 = std::array::from_fn(|k| velocity[3 * cell + k]);
                let slope = add(moving, scale(normal, dot(moving, normal) / 3.0));
                force = add(force, scale(slope, viscosity * size / height));
            }
        }
        let unit = flow.dynamic_pressure() * flow.area.unwrap_or(1.0);
        Coefficients { lift: dot(force, flow.upwards()) / unit, drag: dot(force, flow.downstream()) / unit }
    }

    /// Whether there is no wall.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }
}

/// What acts on the walls.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Coefficients {
    /// C_L.
    pub lift: f64,
    /// C_D.
    pub drag: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::Dataset;
    use crate::mesh::samples::{cube, on_prisms};

    #[test]
    fn a_constant_pressure_pushes_on_one_side_of_a_cube() {
        let all = Cells::of(Dataset { mesh: cube(2), ..Dataset::default() });
        let mesh = &all.mesh;
        let flow: Flow =
            toml::from_str("mach = 1.0\narea = 2.0\nangle_of_attack = 90.0\nwalls = ['a']\nreynolds = 10.0").unwrap();
        let side = |axis: usize| {
            let on = |nodes: &[u32; 3]| nodes.iter().all(|&v| mesh.vertices[v as usize][axis] == 1.0);
            mesh.triangles.refs[mesh.triangles.nodes.iter().position(on).unwrap()]
        };
        let cells = all.count();
        // Upwards is −x, downstream z: 2 more than outside on the side x = 1 of area 1 pushes to +x.
        let rest = vec![0.0; 3 * cells];
        let found = Walls::of(&all, &[side(0)]).coefficients(&flow, &vec![3.0; cells], &rest);
        assert!((found.lift + 2.0 / (0.7 * 2.0)).abs() < 1e-12 && found.drag.abs() < 1e-12, "{found:?}");
        // Where all sides are walls nothing is left.
        let found = Walls::of(&all, &[1, 2, 3, 4, 5, 6]).coefficients(&flow, &vec![3.0; cells], &rest);
        assert!(found.lift.abs() < 1e-12 && found.drag.abs() < 1e-12, "{found:?}");
        // A flow along z drags the wall along, and a flow that is stopped by it pushes with 4/3 of its slope.
        let velocity: Vec<f64> = (0..cells).flat_map(|_| [5.0, 0.0, 1.0]).collect();
        let walls = Walls::of(&all, &[side(0)]);
        let found = walls.coefficients(&flow, &vec![1.0; cells], &velocity);
        let slope: f64 = walls.pieces.iter().map(|piece| norm(piece.area) / piece.height).sum();
        assert!((found.drag - flow.viscosity() * slope / 1.4).abs() < 1e-12, "{found:?}");
        assert!((found.lift + 4.0 / 3.0 * 5.0 * flow.viscosity() * slope / 1.4).abs() < 1e-12, "{found:?}");
        assert!(walls.pieces.iter().all(|piece| (piece.height - 0.125).abs() < 1e-12));
    }

    #[test]
    fn at_a_layer_of_prisms_the_wall_has_their_values() {
        let (mut mesh, mut stack) = on_prisms(2, 0.1);
        stack.join(&mut mesh).unwrap();
        let all = Cells::of(Dataset { mesh, stack, ..Dataset::default() });
        let flow: Flow = toml::from_str("mach = 1.0\nwalls = ['a']\nreynolds = 10.0").unwrap();
        // Below; the pressure is that of the prisms, which come last, 2 more than outside, and the flow goes along x.
        let walls = Walls::of(&all, &[5]);
        assert!(walls.pieces.iter().all(|piece| (piece.height - 0.05).abs() < 1e-12));
        let pressure: Vec<f64> = (0..all.count()).map(|cell| if cell < 48 { 9.0 } else { 3.0 }).collect();
        let velocity: Vec<f64> = (0..all.count()).flat_map(|_| [1.0, 0.0, 0.0]).collect();
        let found = walls.coefficients(&flow, &pressure, &velocity);
        assert!((found.lift + 2.0 / 0.7).abs() < 1e-12, "{found:?}");
        assert!((found.drag - flow.viscosity() / 0.05 / 0.7).abs() < 1e-12, "{found:?}");
    }
}
