//! Leaves out added points that no tetrahedron has: those that were added outside, to recover an edge there.
use super::{Origin, Tetrahedra};

/// Numbers the points anew; those of the input, which are `input`, stay.
pub fn drop_unused(r: &mut Tetrahedra, input: usize) {
    let mut is_kept: Vec<bool> = (0..r.points.len()).map(|v| v < input).collect();
    r.tets.iter().flatten().chain(r.triangles.iter().flatten()).for_each(|&v| is_kept[v as usize] = true);
    if !is_kept.contains(&false) {
        return;
    }
    let mut number = Vec::with_capacity(is_kept.len());
    let mut next = 0;
    for kept in &is_kept {
        number.push(next);
        next += u32::from(*kept);
    }
    let renumber = |v: &mut u32| *v = number[*v as usize];
    r.tets.iter_mut().flatten().for_each(renumber);
    r.triangles.iter_mut().flatten().for_each(renumber);
    let mut place = is_kept.iter();
    r.points.retain(|_| place.next() == Some(&true));
    let mut place = is_kept.iter().skip(input);
    r.added.retain(|_| place.next() == Some(&true));
    for added in &mut r.added {
        match &mut added.origin {
            Origin::Edge(ends) => ends.iter_mut().for_each(renumber),
            Origin::Triangle(corners) => corners.iter_mut().for_each(renumber),
            Origin::Inside => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Added;
    use super::*;

    #[test]
    fn a_point_outside_goes_and_the_others_keep_their_order() {
        let at = |x: f64| [x, 0.0, 0.0];
        let added = |x, origin| Added { point: at(x), origin };
        let mut r = Tetrahedra {
            points: (0..8).map(|i| at(f64::from(i))).collect(),
            // Point 5 lies outside; point 4 of the input is kept, though nothing has it.
            added: vec![added(5.0, Origin::Inside), added(6.0, Origin::Edge([0, 1])), added(7.0, Origin::Edge([0, 6]))],
            tets: vec![[0, 1, 2, 6], [1, 2, 3, 7]],
            triangles: vec![[0, 6, 7]],
            ..Tetrahedra::default()
        };
        drop_unused(&mut r, 5);
        assert_eq!(r.points.iter().map(|p| p[0]).collect::<Vec<_>>(), [0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 7.0]);
        assert_eq!(r.tets, [[0, 1, 2, 5], [1, 2, 3, 6]]);
        assert_eq!(r.triangles, [[0, 5, 6]]);
        assert_eq!(r.added, [added(6.0, Origin::Edge([0, 1])), added(7.0, Origin::Edge([0, 5]))]);
    }
}
