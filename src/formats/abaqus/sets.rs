//! Which sets and surfaces name which elements.
use super::super::sets::Kind;
use super::{Group, Reader, Set};
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

/// Vertices of the sides S1 to S4 of a tetrahedron (Abaqus).
const SIDES: [[usize; 3]; 4] = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];

/// An element, by its kind and place.
type Element = (Kind, usize);

/// What is known while sets name groups.
struct Naming {
    /// Elements of each group.
    counts: BTreeMap<usize, usize>,
    /// Groups that have the name of a set already.
    is_renamed: BTreeSet<usize>,
}

impl Reader<'_> {
    /// Gives elements without a set the first one that they are in, a group the name of a set that is all of it, and makes triangles of the
    /// sides of surfaces.
    pub(super) fn resolve_sets(&mut self) {
        if self.sets.is_empty() {
            return;
        }
        let mut place: HashMap<usize, Element> = HashMap::new();
        let lists = [(Kind::Tetrahedra, &self.tets.numbers), (Kind::Triangles, &self.triangles.numbers)];
        for (kind, numbers) in lists.into_iter().chain([(Kind::Edges, &self.edges.numbers)]) {
            place.extend(numbers.iter().enumerate().map(|(at, &number)| (number, (kind, at))));
        }
        let sets = std::mem::take(&mut self.sets);
        // Before groups are renamed.
        let members: Vec<Vec<usize>> = sets.iter().map(|set| self.members(set, &sets)).collect();
        let mut known: HashSet<[usize; 3]> = self.triangles.nodes.iter().map(|&nodes| sorted(nodes)).collect();
        for set in sets.iter().filter(|set| set.is_surface) {
            self.sides(set, &sets, &place, &mut known);
        }
        let mut naming = Naming { counts: self.counts(), is_renamed: BTreeSet::new() };
        for (set, elements) in sets.iter().zip(&members) {
            let found: BTreeSet<Element> = elements.iter().filter_map(|number| place.get(number)).copied().collect();
            self.name_elements(set, &found, &mut naming);
        }
    }

    /// The elements of a set and of the sets in it; of *ELEMENT's too.
    fn members(&self, set: &Set, sets: &[Set]) -> Vec<usize> {
        let mut found = set.elements.clone();
        for (name, side) in &set.sets {
            if *side == 0 {
                found.extend(self.called(name, sets));
            }
        }
        found
    }

    /// The elements of the set of such a name. Sets of sets of sets are not followed.
    fn called(&self, name: &str, sets: &[Set]) -> Vec<usize> {
        let is_it = |other: &str| other.eq_ignore_ascii_case(name);
        if let Some(set) = sets.iter().find(|set| !set.is_surface && is_it(&set.name)) {
            return set.elements.clone();
        }
        let of = |numbers: &[usize], groups: &[usize]| -> Vec<usize> {
            let all = numbers.iter().zip(groups).filter(|(_, group)| is_it(&self.groups[**group].name));
            all.map(|(&number, _)| number).collect()
        };
        let mut found = of(&self.tets.numbers, &self.tets.groups);
        found.extend(of(&self.triangles.numbers, &self.triangles.groups));
        found.extend(of(&self.edges.numbers, &self.edges.groups));
        found
    }

    /// How many elements each group has.
    fn counts(&self) -> BTreeMap<usize, usize> {
        let mut counts = BTreeMap::new();
        for &group in self.tets.groups.iter().chain(&self.triangles.groups).chain(&self.edges.groups) {
            *counts.entry(group).or_insert(0) += 1;
        }
        counts
    }

    fn groups_of(&mut self, kind: Kind) -> &mut Vec<usize> {
        match kind {
            Kind::Tetrahedra => &mut self.tets.groups,
            Kind::Triangles => &mut self.triangles.groups,
            Kind::Edges => &mut self.edges.groups,
        }
    }

    /// A set of elements by kind: those without a group are one now; groups that are all in it get its name, unless all of the kind are.
    fn name_elements(&mut self, set: &Set, elements: &BTreeSet<Element>, naming: &mut Naming) {
        // A surface names no solid.
        for kind in Kind::ALL.into_iter().filter(|kind| !set.is_surface || *kind == Kind::Triangles) {
            let mut inside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
            for &(_, at) in elements.iter().filter(|(of, _)| *of == kind) {
                inside.entry(self.groups_of(kind)[at]).or_default().push(at);
            }
            let of_kind = |&(&group, &count): &(&usize, &usize)| self.groups[group].kind == kind && count > 0;
            let mut there = naming.counts.iter().filter(of_kind);
            let is_all = inside.len() > 1
                && there.all(|(group, &count)| inside.get(group).is_some_and(|places| places.len() == count));
            for (group, places) in inside.into_iter().filter(|_| !is_all) {
                let Group { name, noted, .. } = &self.groups[group];
                if name.is_empty() && noted.is_none() {
                    let to = self.group(kind, &set.name, None);
                    *naming.counts.entry(group).or_default() -= places.len();
                    *naming.counts.entry(to).or_default() += places.len();
                    for at in places {
                        self.groups_of(kind)[at] = to;
                    }
                } else if noted.is_none()
                    && naming.counts.get(&group) == Some(&places.len())
                    && naming.is_renamed.insert(group)
                {
                    self.groups[group].name.clone_from(&set.name);
                }
            }
        }
    }

    /// Triangles of the sides of a surface, where there are none yet.
    fn sides(&mut self, set: &Set, sets: &[Set], place: &HashMap<usize, Element>, known: &mut HashSet<[usize; 3]>) {
        let mut sides = set.sides.clone();
        for (name, side) in set.sets.iter().filter(|(_, side)| *side > 0) {
            sides.extend(self.called(name, sets).into_iter().map(|number| (number, *side)));
        }
        let group = self.group(Kind::Triangles, &set.name, None);
        for (number, side) in sides {
            let Some(&(Kind::Tetrahedra, at)) = place.get(&number) else { continue };
            let nodes = SIDES[usize::from(side) - 1].map(|k| self.tets.nodes[at][k]);
            if known.insert(sorted(nodes)) {
                self.triangles.push(0, nodes, group);
            }
        }
    }
}

fn sorted(mut nodes: [usize; 3]) -> [usize; 3] {
    nodes.sort_unstable();
    nodes
}

/// References of the groups: what comments tell, else the number that a name is, else the next free one of the kind.
pub(super) fn references(groups: &[Group]) -> Vec<i32> {
    let mut used: BTreeSet<(Kind, i32)> = BTreeSet::new();
    let told = |group: &Group| group.noted.as_ref().map(|noted| noted.reference);
    let mut found: Vec<Option<i32>> = groups.iter().map(told).collect();
    used.extend(groups.iter().zip(&found).filter_map(|(group, reference)| Some((group.kind, (*reference)?))));
    for (group, reference) in groups.iter().zip(&mut found).filter(|(_, reference)| reference.is_none()) {
        let number = group.name.parse::<i32>().ok().filter(|number| number.to_string() == group.name);
        *reference = number.filter(|&number| used.insert((group.kind, number)));
    }
    let free = |kind: Kind, used: &mut BTreeSet<(Kind, i32)>| (1..).find(|&number| used.insert((kind, number)));
    let all = groups.iter().zip(found);
    all.map(|(group, reference)| reference.or_else(|| free(group.kind, &mut used)).unwrap_or(i32::MAX)).collect()
}
