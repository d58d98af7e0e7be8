//! The surface of a mesh: its triangles, what lies behind them, and its ridges.
use crate::mesh::adjacency::{FACES, MatchedFaces, NONE, TriangleIndex};
use crate::mesh::vector::{area2, dot, unit};
use crate::mesh::{Elements, TetMesh};
use crate::tasks::{GRAIN, Team};

/// An edge at which the normals turn by more is a ridge where the mesh lists none (degrees).
const RIDGE_ANGLE: f64 = 30.0;

/// Triangles to be shown.
pub struct Surface {
    /// The triangles of the mesh; without any, the faces of one tetrahedron, of reference 0.
    pub triangles: Elements<3>,
    /// The tetrahedra on both sides of each, [`NONE`] where there is none; the first is there before the second.
    pub sides: Vec<[u32; 2]>,
    /// Of each tetrahedron a bit for each face that is one of the triangles.
    pub masks: Vec<u8>,
}

impl Surface {
    /// Of a mesh.
    pub fn of(team: Team<'_>, mesh: &TetMesh) -> Self {
        let triangles = if mesh.triangles.is_empty() { skin(team, mesh) } else { mesh.triangles.clone() };
        let mut sides = vec![[NONE; 2]; triangles.len()];
        let mut masks = vec![0; mesh.tets.len()];
        let index = TriangleIndex::new(team, &triangles.nodes, mesh.vertices.len());
        for side in index.sides(team, &mesh.tets.nodes) {
            masks[side.tet as usize] |= 1 << side.face;
            let beside = &mut sides[side.triangle as usize];
            let slot = usize::from(beside[0] != NONE);
            beside[slot] = side.tet;
        }
        Self { triangles, sides, masks }
    }
}

/// The faces of one tetrahedron only.
fn skin(team: Team<'_>, mesh: &TetMesh) -> Elements<3> {
    let tets = &mesh.tets.nodes;
    let neighbours = MatchedFaces::of(team, tets).neighbours;
    let nodes = team.collect(GRAIN, tets.len(), |range, found| {
        for tet in range {
            let open = (0..4).filter(|&face| neighbours[tet][face] == NONE);
            found.extend(open.map(|face| FACES[face].map(|i| tets[tet][i])));
        }
    });
    Elements { refs: vec![0; nodes.len()], nodes }
}

/// The edges that the mesh lists; without any, those between references, at borders, and where the surface has a ridge.
pub fn ridges(team: Team<'_>, mesh: &TetMesh, triangles: &Elements<3>) -> Elements<2> {
    if !mesh.edges.is_empty() {
        return mesh.edges.clone();
    }
    let mut sides = team.collect(GRAIN, triangles.len(), |range, sides| {
        for triangle in range {
            let nodes = triangles.nodes[triangle];
            sides.extend((0..3).map(|i| {
                let (a, b) = (nodes[i], nodes[(i + 1) % 3]);
                ([a.min(b), a.max(b)], triangle as u32, a < b)
            }));
        }
    });
    team.sort(&mut sides);
    let normal = |triangle: u32| {
        let [a, b, c] = triangles.nodes[triangle as usize].map(|v| mesh.vertices[v as usize]);
        unit(area2(a, b, c))
    };
    let cosine = RIDGE_ANGLE.to_radians().cos();
    let mut found = Elements::default();
    for beside in sides.chunk_by(|a, b| a.0 == b.0) {
        let is_ridge = match beside {
            &[(_, a, up), (_, b, also_up)] => {
                // Triangles turned alike go through their edge in opposite directions; those of a file need not be.
                let sign = if up == also_up { -1.0 } else { 1.0 };
                let turn = sign * dot(normal(a), normal(b));
                triangles.refs[a as usize] != triangles.refs[b as usize] || turn < cosine
            }
            _ => true,
        };
        if is_ridge {
            found.push(beside[0].0, 0);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::samples::cube;

    #[test]
    fn a_cube_has_its_twelve_edges() {
        let n = 3;
        let mesh = cube(n);
        let surface = Surface::of(Team::alone(), &mesh);
        assert_eq!(ridges(Team::alone(), &mesh, &surface.triangles).len(), 12 * n as usize);
        // The same without references: then the angle tells.
        let mut bare = mesh.clone();
        bare.triangles = Elements::default();
        let skin = Surface::of(Team::alone(), &bare);
        assert_eq!(skin.triangles.len(), mesh.triangles.len());
        assert_eq!(ridges(Team::alone(), &bare, &skin.triangles).len(), 12 * n as usize);
        assert_eq!(skin.masks, surface.masks);
    }

    #[test]
    fn each_triangle_knows_what_is_behind() {
        let mesh = cube(2);
        let surface = Surface::of(Team::alone(), &mesh);
        for (nodes, &[tet, other]) in surface.triangles.nodes.iter().zip(&surface.sides) {
            assert!(nodes.iter().all(|v| mesh.tets.nodes[tet as usize].contains(v)) && other == NONE);
        }
        let faces: u32 = surface.masks.iter().map(|mask: &u8| mask.count_ones()).sum();
        assert_eq!(faces as usize, mesh.triangles.len());
    }
}
