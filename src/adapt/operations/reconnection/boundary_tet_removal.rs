//! Removal of a boundary tetrahedron: one with two surface triangles of the same model face goes, and its other two faces become the
//! surface. On a curved wall long edges leave such tetrahedra, flat between four points of the wall.
use crate::adapt::core::access::Access;
use crate::adapt::core::ids::{FACE, TetId, VertexId};
use crate::adapt::core::refusal::Refusal;
use crate::adapt::core::worker::Worker;

impl<A: Access> Worker<'_, '_, A> {
    /// Removes a claimed tetrahedron at the surface edge a–b.
    ///
    /// # Errors
    /// `Topology` when a–b is not an edge of exactly two surface triangles, both of this tetrahedron and of one face, or the opposite edge is
    /// on the surface already; `Geometry` when the edge must stay; `Normal` when the surface would turn from its model;
    /// `Crossing` when it would pass through itself.
    pub fn remove_boundary_tet(&mut self, t: TetId, a: VertexId, b: VertexId) -> Result<(), Refusal> {
        let (v, n, tags) = (self.store.vertices(t), self.store.neighbours(t), self.store.tags(t));
        // The two faces at the edge a–b lie opposite c and d. Those opposite a and b become the surface.
        let mut across = (0..4).filter(|&i| v[i] != a && v[i] != b);
        let (Some(c), Some(d)) = (across.next(), across.next()) else { return Err(Refusal::Topology) };
        let own = |x: VertexId| v.iter().position(|&y| y == x).ok_or(Refusal::Topology);
        let (i, j) = (own(a)?, own(b)?);
        let tag = tags[c];
        let is_surface = |k: usize| tags[k] == tag && !n[k].is_some();
        let is_inside = |k: usize| tags[k] == 0 && n[k].is_some();
        if tag == 0 || !is_surface(c) || !is_surface(d) || !is_inside(i) || !is_inside(j) {
            return Err(Refusal::Topology);
        }
        if self.store.ridge_curve(a, b).is_some() {
            return Err(Refusal::Geometry);
        }
        let ends = [v[c], v[d]];
        self.claim_tet(n[i])?;
        self.claim_tet(n[j])?;
        self.gather_shell(ends[0], ends[1], t)?;
        if !self.state.shell.closed || self.state.shell.surface_tags().next().is_some() {
            return Err(Refusal::Topology);
        }
        // Outward: the old triangles as they are, the new ones reversed.
        let outward = |k: usize| {
            let [x, y, z] = FACE[k].map(|l| v[l]);
            ([x, z, y], tag)
        };
        let inward = |k: usize| (FACE[k].map(|l| v[l]), tag);
        self.compare_normals(&[outward(c), outward(d)], &[inward(i), inward(j)], 0.0)?;
        self.take_out_tet(t, [(n[i], [b, ends[0], ends[1]]), (n[j], [a, ends[0], ends[1]])], tag)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::core::access::Exclusive;
    use crate::adapt::core::check::check;
    use crate::adapt::core::context::Context;
    use crate::adapt::core::fill::{self, Filled};
    use crate::adapt::core::worker::State;
    use crate::geometry::discrete::DEFAULT_RIDGE_ANGLE;
    use crate::geometry::{Discrete, Model};
    use crate::mesh::TetMesh;
    use crate::mesh::adjacency::FACES;
    use crate::metric::{Background, Source, Sym3};
    use crate::tasks::Team;
    use std::collections::BTreeMap;

    /// A shallow roof with the ridge a–b over the edge c–d, about which two more tetrahedra reach down to a fifth point. Returns the
    /// result of removing the tetrahedron under the roof, and the number of tetrahedra that are left.
    fn shed_roof(height: f64) -> (Result<(), Refusal>, usize, Result<(), String>) {
        let vertices =
            vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, height], [0.0, 1.0, height], [0.0, 0.0, -2.0]];
        let mut mesh = TetMesh { vertices, vertex_refs: vec![0; 5], ..TetMesh::default() };
        for tet in [[0, 2, 1, 3], [0, 3, 1, 4], [0, 4, 1, 2]] {
            mesh.tets.push(tet, 1);
        }
        let mut sides: BTreeMap<[u32; 3], Vec<[u32; 3]>> = BTreeMap::new();
        for tet in &mesh.tets.nodes {
            for face in FACES {
                let face = face.map(|k| tet[k]);
                let mut key = face;
                key.sort_unstable();
                sides.entry(key).or_default().push(face);
            }
        }
        for faces in sides.into_values().filter(|faces| faces.len() == 1) {
            mesh.triangles.push(faces[0], 1);
        }
        let (model, place) = Discrete::from_mesh(Team::alone(), &mesh, DEFAULT_RIDGE_ANGLE).expect("it has a surface");
        let background = Background::new(mesh.vertices.clone(), mesh.tets.nodes.clone(), vec![Sym3::ZERO; 5]);
        let (model, source) = (Model::Discrete(model), Source::Background(background));
        let Filled { store, ids, .. } = fill::fill(Team::alone(), &mesh, &place, &source).expect("it is valid");
        let context = Context::new(store, &source, &model);
        let store = &context.store;
        let [a, b] = [ids[2], ids[3]];
        let roof = store.live_tets().find(|&t| store.vertices(t).contains(&a) && store.vertices(t).contains(&b));
        let roof = roof.expect("it is there");
        let mut state = State::new(&context);
        let result = Worker::new(&context, &mut state, Exclusive).remove_boundary_tet(roof, a, b);
        (result, store.live_tets().count(), check(&context))
    }

    #[test]
    fn a_flat_tetrahedron_under_the_surface_goes() {
        assert_eq!(shed_roof(0.05), (Ok(()), 2, Ok(())));
    }

    #[test]
    fn an_edge_of_the_model_stays() {
        // The roof's slopes meet at more than the ridge angle: they are two faces.
        assert_eq!(shed_roof(2.0), (Err(Refusal::Topology), 3, Ok(())));
    }
}
