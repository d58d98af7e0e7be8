//! Bodies that share no face: each has a closed surface of its own.
use crate::surface::Surface;

/// Which faces bound the same body: one solid, or several that share faces.
pub struct Bodies {
    /// Body of each face, by its first solid; none of a face that bounds no solid.
    of_face: Vec<Option<u32>>,
}

impl Bodies {
    /// Those of a surface.
    pub fn of(surface: &Surface) -> Self {
        let count = surface.sides.iter().flatten().flatten().max().map_or(0, |&last| last + 1);
        let mut first: Vec<u32> = (0..count).collect();
        // The lowest solid goes from face to face until nothing changes.
        loop {
            let mut has_changed = false;
            for sides in &surface.sides {
                if let [Some(a), Some(b)] = *sides {
                    let least = first[a as usize].min(first[b as usize]);
                    has_changed |= first[a as usize] != least || first[b as usize] != least;
                    (first[a as usize], first[b as usize]) = (least, least);
                }
            }
            if !has_changed {
                break;
            }
        }
        let of_face = surface.sides.iter().map(|[a, b]| a.or(*b).map(|solid| first[solid as usize])).collect();
        Self { of_face }
    }

    /// Whether two triangles bound different bodies.
    pub fn are_apart(&self, surface: &Surface, pair: [u32; 2]) -> bool {
        let [a, b] = pair.map(|t| self.of_face[surface.faces[t as usize] as usize]);
        a.is_some() && b.is_some() && a != b
    }

    /// The surface of each body, with the points that it has triangles at; faces keep their numbers. What bounds no body is left out.
    pub fn divide(&self, whole: &Surface) -> Vec<Surface> {
        let mut bodies: Vec<u32> = self.of_face.iter().flatten().copied().collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies.into_iter().map(|body| self.surface_of(whole, body)).collect()
    }

    fn surface_of(&self, whole: &Surface, body: u32) -> Surface {
        const NONE: u32 = u32::MAX;
        let mut number = vec![NONE; whole.points.len()];
        let mut part = Surface { sides: whole.sides.clone(), ..Surface::default() };
        for (nodes, face) in whole.triangles.iter().zip(&whole.faces) {
            if self.of_face[*face as usize] == Some(body) {
                part.triangles.push(*nodes);
                part.faces.push(*face);
                nodes.iter().for_each(|&v| number[v as usize] = 0);
            }
        }
        for (v, new) in number.iter_mut().enumerate().filter(|(_, new)| **new != NONE) {
            *new = part.points.len() as u32;
            part.points.push(whole.points[v]);
            part.places.push(whole.places[v]);
        }
        let renumber = |v: &u32| number[*v as usize];
        part.triangles.iter_mut().flatten().for_each(|v| *v = renumber(v));
        let chain = |chain: &Vec<u32>| -> Vec<u32> {
            let new: Vec<u32> = chain.iter().map(renumber).collect();
            if new.contains(&NONE) { Vec::new() } else { new }
        };
        part.chains = whole.chains.iter().map(chain).collect();
        part
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces 0 and 1 bound solid 0, which shares face 1 with solid 2; face 2 bounds solid 1, face 3 nothing.
    fn surface() -> Surface {
        Surface {
            points: (0..12).map(|i| [f64::from(i), 0.0, 0.0]).collect(),
            places: (0..12).map(crate::surface::Place::Vertex).collect(),
            triangles: vec![[0, 1, 2], [1, 2, 3], [6, 7, 8], [9, 10, 11]],
            faces: vec![0, 1, 2, 3],
            sides: vec![[Some(0), None], [Some(2), Some(0)], [None, Some(1)], [None, None]],
            chains: vec![vec![1, 2], vec![6, 7], vec![0, 6]],
            ..Surface::default()
        }
    }

    #[test]
    fn bodies_that_share_a_face_are_one() {
        let surface = surface();
        let bodies = Bodies::of(&surface);
        assert_eq!(bodies.of_face, [Some(0), Some(0), Some(1), None]);
        assert!(bodies.are_apart(&surface, [1, 2]) && bodies.are_apart(&surface, [2, 0]));
        assert!(!bodies.are_apart(&surface, [0, 1]) && !bodies.are_apart(&surface, [2, 3]));
    }

    #[test]
    fn each_body_has_its_own_points_and_edges() {
        let whole = surface();
        let parts = Bodies::of(&whole).divide(&whole);
        let points: Vec<f64> = parts.iter().flat_map(|part| part.points.iter().map(|p| p[0])).collect();
        assert_eq!(points, [0.0, 1.0, 2.0, 3.0, 6.0, 7.0, 8.0]);
        assert_eq!(parts[0].triangles, [[0, 1, 2], [1, 2, 3]]);
        assert_eq!((&parts[1].triangles, &parts[1].faces), (&vec![[0, 1, 2]], &vec![2]));
        assert_eq!(parts[0].chains, [vec![1, 2], vec![], vec![]]);
        assert_eq!(parts[1].chains, [vec![], vec![0, 1], vec![]]);
    }
}
