//! The first points: in each connected part of each region one voxel's centre and, around it, points of its surface. So no part is missed,
//! however small beside the tetrahedra.
use super::delaunay::Worker;
use super::domain::Domain;
use super::store::{Alone, Refusal, Role};
use crate::mesh::vector::{Vec3, add, distance, scale, sub};

/// A point of each connected part of the regions: the centre of the voxel that is nearest to the middle of the part.
pub fn centres(domain: &Domain) -> Vec<Vec3> {
    let [x, y, z] = domain.padded();
    let mut seen = vec![false; x * y * z];
    let (mut found, mut part) = (Vec::new(), Vec::new());
    for first in 0..seen.len() {
        let region = domain.voxel_region(first);
        if region == 0 || seen[first] {
            continue;
        }
        part.clear();
        part.push(first);
        seen[first] = true;
        let mut next = 0;
        while let Some(&voxel) = part.get(next) {
            next += 1;
            // All voxels of regions have neighbours on all sides: the outermost layer is outside.
            for step in [1, x, x * y] {
                for other in [voxel - step, voxel + step] {
                    if !seen[other] && domain.voxel_region(other) == region {
                        seen[other] = true;
                        part.push(other);
                    }
                }
            }
        }
        let sum = part.iter().fold([0.0; 3], |sum, &voxel| add(sum, domain.voxel_centre(voxel)));
        let middle = scale(sum, 1.0 / part.len() as f64);
        let far = |&voxel: &usize| distance(domain.voxel_centre(voxel), middle);
        found.extend(part.iter().min_by(|a, b| far(a).total_cmp(&far(b))).map(|&voxel| domain.voxel_centre(voxel)));
    }
    found
}

/// Points of the surface about a centre, in 26 directions.
pub fn around(domain: &Domain, centre: Vec3) -> Vec<Vec3> {
    let region = domain.region(centre);
    let [a, b, c] = domain.frame().axes;
    let step = 0.25 * domain.least_spacing();
    let mut found = Vec::new();
    for direction in (0..27).filter(|&direction| direction != 13) {
        let part = |i: i32| f64::from(direction / 3_i32.pow(i as u32) % 3 - 1);
        let along = add(scale(a, part(0)), add(scale(b, part(1)), scale(c, part(2))));
        let along = scale(along, step / distance(along, [0.0; 3]));
        let mut at = centre;
        loop {
            let next = add(at, along);
            let beyond = domain.region(next);
            if beyond != region {
                found.push(domain.crossing((at, region), (next, beyond)));
                break;
            }
            at = next;
        }
    }
    found
}

/// Inserts the first points of a part; those too near to others are left out.
pub fn plant(worker: &mut Worker<'_, Alone>, centre: Vec3, nearest: f64, start: &mut u32) -> Result<(), Refusal> {
    let surface = around(worker.domain, centre);
    let points = surface.into_iter().map(|p| (p, Role::Surface)).chain([(centre, Role::Inner)]);
    for (p, role) in points {
        if sub(p, centre).iter().all(|x| x.abs() < nearest) && role == Role::Surface {
            continue;
        }
        let t = worker.locate(p, *start);
        *start = t;
        // A point at a vertex lies inside no circumsphere, so it cannot be inserted.
        if worker.in_conflict(t, p) {
            worker.dig(p, t)?;
            if worker.room(p) >= nearest {
                worker.fill(p, role)?;
                *start = worker.scratch.fresh[0];
            }
        }
    }
    Ok(())
}
