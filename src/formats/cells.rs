//! Values of cells to the vertices, and back.
use crate::mesh::TetMesh;
use crate::mesh::vector::{Vec3, distance};
use crate::tasks::{Buckets, GRAIN, Team};

/// The centroid of a tetrahedron.
fn centroid(vertices: &[Vec3], nodes: [u32; 4]) -> Vec3 {
    let p = nodes.map(|v| vertices[v as usize]);
    std::array::from_fn(|k| 0.25 * (p[0][k] + p[1][k] + p[2][k] + p[3][k]))
}

/// Values at the vertices, shape (vertices, width): the mean of those of the cells at each, shape (tetrahedra, width), weighted by the
/// inverse of the distance to their centroids. Zero at a vertex without a tetrahedron. The same to the bit on any number of threads.
///
/// Weights that keep linear functions (Holmes & Connell, AIAA 89-1932) smooth less, and a solver's values have noise from cell to cell, which the
/// metric takes for curvature: with them the shock of cases/ramp (`--short`) was 1.3 times as thick, and the lift of
/// cases/delta-wing-flow (`--short`) off by 3.6 % instead of 1.2 %.
pub fn cells_to_vertices(team: Team<'_>, mesh: &TetMesh, values: &[f64], width: usize) -> Vec<f64> {
    let (vertices, tets) = (&mesh.vertices, &mesh.tets.nodes);
    let at = Buckets::of::<4>(team, vertices.len(), tets.len(), |t| tets[t]);
    team.collect(GRAIN, vertices.len(), |range, found| {
        let mut sum = vec![0.0; width];
        for vertex in range {
            sum.fill(0.0);
            let mut total = 0.0;
            for entry in at.of_key(vertex) {
                let tet = entry as usize / 4;
                let far = distance(vertices[vertex], centroid(vertices, tets[tet]));
                // A tetrahedron of no extent counts as much as all others together could.
                let weight = 1.0 / far.max(f64::MIN_POSITIVE.sqrt());
                total += weight;
                sum.iter_mut().zip(&values[tet * width..]).for_each(|(sum, value)| *sum += weight * value);
            }
            found.extend(sum.iter().map(|&sum| if total > 0.0 { sum / total } else { 0.0 }));
        }
    })
}

/// Values of the cells, shape (tetrahedra, width): the mean of those at the vertices of each, shape (vertices, width), which is the
/// value of their linear interpolant at the centroid.
pub fn vertices_to_cells(team: Team<'_>, mesh: &TetMesh, values: &[f64], width: usize) -> Vec<f64> {
    team.collect(GRAIN, mesh.tets.len(), |range, found| {
        for nodes in &mesh.tets.nodes[range] {
            found.extend((0..width).map(|k| 0.25 * nodes.iter().map(|&v| values[v as usize * width + k]).sum::<f64>()));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn constants_stay_and_linear_functions_are_met_at_centroids() {
        let mesh = cube(3);
        let team = Team::alone();
        let linear: Vec<f64> = mesh.vertices.iter().flat_map(|p| [1.0 + p[0] - 2.0 * p[2], 3.0]).collect();
        let cells = vertices_to_cells(team, &mesh, &linear, 2);
        for (nodes, value) in mesh.tets.nodes.iter().zip(cells.chunks(2)) {
            let p = centroid(&mesh.vertices, *nodes);
            assert!((value[0] - (1.0 + p[0] - 2.0 * p[2])).abs() < 1e-14 && value[1] == 3.0);
        }
        let back = cells_to_vertices(team, &mesh, &cells, 2);
        assert_eq!(back.len(), linear.len());
        for (p, value) in mesh.vertices.iter().zip(back.chunks(2)) {
            assert!((value[1] - 3.0).abs() < 1e-14);
            // Where there are cells all around it is the function's, to within the mesh's lack of symmetry.
            let inside = p.iter().all(|&x| x > 0.0 && x < 1.0);
            assert!(!inside || (value[0] - (1.0 + p[0] - 2.0 * p[2])).abs() < 0.05, "{p:?}: {}", value[0]);
        }
    }

    #[test]
    fn no_value_is_beyond_those_of_the_cells() {
        let step = |p: Vec3| if p[0] + 0.3 * p[1] > 0.61 { 1.0 } else { 0.0 };
        let mut mesh = cube(5);
        mesh.vertices.push([0.5; 3]);
        mesh.vertex_refs.push(0);
        let cells: Vec<f64> = mesh.tets.nodes.iter().map(|&nodes| step(centroid(&mesh.vertices, nodes))).collect();
        let found = cells_to_vertices(Team::alone(), &mesh, &cells, 1);
        assert!(found.iter().all(|x| (-1e-15..=1.0 + 1e-15).contains(x)));
        assert_eq!(found.last(), Some(&0.0), "without a tetrahedron");
        // One tetrahedron: all its vertices have its value.
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let single = crate::mesh::samples::with_boundary(corners.to_vec(), vec![[0, 1, 2, 3]]);
        assert!(cells_to_vertices(Team::alone(), &single, &[7.0], 1).iter().all(|x| (x - 7.0).abs() < 1e-14));
    }
}
