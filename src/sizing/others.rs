//! The other entities near a place, in the order in which they are looked at.
use crate::geometry::Entity;
use crate::mesh::vector::Vec3;
use std::cmp::Ordering;

/// Another entity, as a place sees it.
#[derive(Clone, Copy)]
pub struct Other {
    /// How far it is; a lower bound before its closest point is known.
    pub length: f64,
    /// Which it is.
    pub to: Entity,
    /// Its closest point; none before it is known.
    pub found: Option<Found>,
}

/// The closest point of another entity.
#[derive(Clone, Copy)]
pub struct Found {
    /// Where it is.
    pub there: Vec3,
    /// Its normal there, if it is a face.
    pub normal: Option<Vec3>,
}

/// The greatest is the nearest. Of two as near, the one whose closest point is not known is greater, since it may be farther.
impl Ord for Other {
    fn cmp(&self, other: &Self) -> Ordering {
        let asked = |one: &Self| one.found.is_some();
        other.length.total_cmp(&self.length).then(asked(other).cmp(&asked(self))).then(other.to.cmp(&self.to))
    }
}

impl PartialOrd for Other {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Other {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Other {}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BinaryHeap;

    #[test]
    fn the_nearest_comes_first_and_of_two_what_is_not_asked_yet() {
        let found = Some(Found { there: [0.0; 3], normal: None });
        let all = [(2.0, 1, None), (1.0, 2, found), (1.0, 3, None), (0.5, 4, found)];
        let mut others: BinaryHeap<Other> =
            all.into_iter().map(|(length, face, found)| Other { length, to: Entity::Face(face), found }).collect();
        let order: Vec<Entity> = std::iter::from_fn(|| others.pop()).map(|other| other.to).collect();
        assert_eq!(order, [4, 3, 2, 1].map(Entity::Face));
    }
}
