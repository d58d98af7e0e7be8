//! Makes the outer boundary a manifold surface: where it touches itself in a vertex or an edge, the smaller side is left out.
use super::extract::Tets;
use crate::mesh::adjacency::FACES;
use crate::mesh::vector::volume6;

/// Leaves tetrahedra out until the others are connected by faces at every vertex and every edge. Returns how many were left out.
pub fn repair(tets: &mut Tets) -> usize {
    let before = tets.regions.iter().filter(|&&region| region != 0).count();
    loop {
        let mut going = loose_at_edges(tets);
        going.extend(loose_at_vertices(tets));
        if going.is_empty() {
            break;
        }
        going.iter().for_each(|&t| tets.regions[t as usize] = 0);
    }
    before - tets.regions.iter().filter(|&&region| region != 0).count()
}

fn is_kept(tets: &Tets, t: u32) -> bool {
    tets.regions.get(t as usize).is_some_and(|&region| region != 0)
}

fn volume(tets: &Tets, t: u32) -> f64 {
    let [a, b, c, d] = tets.nodes[t as usize].map(|v| tets.points[v as usize]);
    volume6(a, b, c, d)
}

/// All but the greatest fan of tetrahedra at each edge with more than one.
fn loose_at_edges(tets: &Tets) -> Vec<u32> {
    let mut edges: Vec<([u32; 2], u32)> = Vec::new();
    for t in (0..tets.nodes.len() as u32).filter(|&t| is_kept(tets, t)) {
        for i in (0..4).filter(|&i| !is_kept(tets, tets.neighbours[t as usize][i])) {
            let face = FACES[i].map(|k| tets.nodes[t as usize][k]);
            for k in 0..3 {
                let [a, b] = [face[k], face[(k + 1) % 3]];
                edges.push(([a.min(b), a.max(b)], t));
            }
        }
    }
    edges.sort_unstable();
    let mut going = Vec::new();
    for same in edges.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 2) {
        let mut fans: Vec<(f64, Vec<u32>)> = Vec::new();
        for &(edge, t) in same {
            if !fans.iter().any(|(_, fan)| fan.contains(&t)) {
                let fan = fan(tets, edge, t);
                fans.push((fan.iter().map(|&t| volume(tets, t)).sum(), fan));
            }
        }
        going.extend(all_but_greatest(fans));
    }
    going
}

/// The kept tetrahedra about an edge that hang together with one of them.
fn fan(tets: &Tets, edge: [u32; 2], first: u32) -> Vec<u32> {
    let mut fan = vec![first];
    let mut next = 0;
    while let Some(&t) = fan.get(next) {
        next += 1;
        for i in (0..4).filter(|&i| !edge.contains(&tets.nodes[t as usize][i])) {
            let n = tets.neighbours[t as usize][i];
            if is_kept(tets, n) && !fan.contains(&n) {
                fan.push(n);
            }
        }
    }
    fan
}

/// All but the greatest group of tetrahedra at each vertex with more than one.
fn loose_at_vertices(tets: &Tets) -> Vec<u32> {
    let mut corners: Vec<(u32, u32)> = Vec::new();
    for t in (0..tets.nodes.len() as u32).filter(|&t| is_kept(tets, t)) {
        corners.extend(tets.nodes[t as usize].map(|v| (v, t)));
    }
    corners.sort_unstable();
    let mut going = Vec::new();
    for same in corners.chunk_by(|a, b| a.0 == b.0) {
        let (mut groups, mut grouped) = (Vec::new(), 0);
        let mut seen = vec![false; same.len()];
        while let Some(first) = seen.iter().position(|&seen| !seen) {
            let mut group = vec![same[first].1];
            seen[first] = true;
            let mut next = 0;
            while let Some(&t) = group.get(next) {
                next += 1;
                for i in (0..4).filter(|&i| tets.nodes[t as usize][i] != same[0].0) {
                    let n = tets.neighbours[t as usize][i];
                    if let Ok(at) = same.binary_search(&(same[0].0, n))
                        && !seen[at]
                    {
                        seen[at] = true;
                        group.push(n);
                    }
                }
            }
            grouped += group.len();
            groups.push((group.iter().map(|&t| volume(tets, t)).sum(), group));
            if grouped == same.len() {
                break;
            }
        }
        going.extend(all_but_greatest(groups));
    }
    going
}

fn all_but_greatest(mut groups: Vec<(f64, Vec<u32>)>) -> Vec<u32> {
    groups.sort_by(|a, b| b.0.total_cmp(&a.0));
    groups.into_iter().skip(1).flat_map(|(_, group)| group).collect()
}
