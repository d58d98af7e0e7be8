//! Where on a surface its label is best seen: in the middle of what is visible of it.
//!
//! The picture is divided into cells; each belongs to the surface that is nearest to the viewer in its middle. A label goes to the cell of
//! its surface that is farthest from cells of others.

/// A triangle of the picture.
pub struct Patch {
    /// Pixels from the left and the top, and how near.
    pub corners: [[f64; 3]; 3],
    /// The surface that it belongs to; none for what only hides others.
    pub owner: Option<i32>,
}

/// Where a label goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The surface.
    pub owner: i32,
    /// The middle of the label, pixels.
    pub at: [f64; 2],
    /// How far it is from what does not belong to the surface, pixels.
    pub room: f64,
}

/// Distances of cells to the side and across a corner.
const STEPS: [f64; 2] = [1.0, std::f64::consts::SQRT_2];

/// Cells, row by row.
struct Cells {
    size: [usize; 2],
    /// What is seen in each; none where there is nothing, or nothing to name.
    owners: Vec<Option<i32>>,
}

/// The spots of all surfaces that are seen, the roomiest first. `cell` is the width of a cell in pixels.
pub fn spots(patches: &[Patch], [width, height]: [usize; 2], cell: f64) -> Vec<Spot> {
    let size = [width, height].map(|x| (x as f64 / cell).ceil() as usize);
    let cells = Cells { size, owners: seen(patches, size, cell) };
    let room = cells.room();
    let mut best: std::collections::BTreeMap<i32, (f64, usize)> = std::collections::BTreeMap::new();
    for (i, (&owner, &room)) in cells.owners.iter().zip(&room).enumerate() {
        let Some(owner) = owner else { continue };
        let kept = best.entry(owner).or_insert((room, i));
        if room > kept.0 {
            *kept = (room, i);
        }
    }
    let spot = |(owner, (room, i)): (i32, (f64, usize))| Spot {
        owner,
        at: [i % size[0], i / size[0]].map(|x| (x as f64 + 0.5) * cell),
        room: room * cell,
    };
    let mut found: Vec<Spot> = best.into_iter().map(spot).collect();
    found.sort_by(|a, b| b.room.total_cmp(&a.room).then(a.owner.cmp(&b.owner)));
    found
}

/// What is nearest in the middle of each cell.
fn seen(patches: &[Patch], [columns, rows]: [usize; 2], cell: f64) -> Vec<Option<i32>> {
    let mut near = vec![f64::NEG_INFINITY; columns * rows];
    let mut owners = vec![None; columns * rows];
    for patch in patches {
        let [a, b, c] = patch.corners.map(|[x, y, near]| [x / cell - 0.5, y / cell - 0.5, near]);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 || !area.is_finite() {
            continue;
        }
        let span = |i: usize, count: usize| {
            let low = a[i].min(b[i]).min(c[i]).ceil().max(0.0) as usize;
            low..(a[i].max(b[i]).max(c[i]).floor() + 1.0).clamp(low as f64, count.max(low) as f64) as usize
        };
        for y in span(1, rows) {
            for x in span(0, columns) {
                let p = [x as f64, y as f64];
                let side = |p: [f64; 2], a: [f64; 3], b: [f64; 3]| {
                    ((a[0] - p[0]) * (b[1] - p[1]) - (a[1] - p[1]) * (b[0] - p[0])) / area
                };
                let w = [side(p, b, c), side(p, c, a), side(p, a, b)];
                let depth = w[0] * a[2] + w[1] * b[2] + w[2] * c[2];
                let at = y * columns + x;
                if w.iter().all(|&w| w >= 0.0) && depth > near[at] {
                    near[at] = depth;
                    owners[at] = patch.owner;
                }
            }
        }
    }
    owners
}

impl Cells {
    /// How far each cell is from the next one of another surface, in cells: a chamfer distance in two sweeps.
    fn room(&self) -> Vec<f64> {
        let [columns, rows] = self.size;
        let count = columns * rows;
        let mut room = vec![f64::INFINITY; count];
        let before = [(-1i64, 0i64, 0), (-1, -1, 1), (0, -1, 0), (1, -1, 1)];
        for sweep in [1i64, -1] {
            for k in 0..count {
                let i = if sweep == 1 { k } else { count - 1 - k };
                let (x, y) = ((i % columns) as i64, (i / columns) as i64);
                for (dx, dy, step) in before {
                    let (nx, ny) = (x + sweep * dx, y + sweep * dy);
                    let inside = nx >= 0 && ny >= 0 && nx < columns as i64 && ny < rows as i64;
                    let other = if inside { Some(ny as usize * columns + nx as usize) } else { None };
                    let beyond = match other {
                        Some(other) if self.owners[other] == self.owners[i] => room[other],
                        _ => 0.0,
                    };
                    room[i] = room[i].min(beyond + STEPS[step]);
                }
            }
        }
        room
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(left: f64, top: f64, wide: f64, near: f64, owner: Option<i32>) -> [Patch; 2] {
        let p =
            [[left, top], [left + wide, top], [left + wide, top + wide], [left, top + wide]].map(|[x, y]| [x, y, near]);
        [[0, 1, 2], [2, 3, 0]].map(|i: [usize; 3]| Patch { corners: i.map(|i| p[i]), owner })
    }

    #[test]
    fn a_label_is_in_the_middle_of_what_is_seen() {
        let alone: Vec<Patch> = square(20.0, 20.0, 40.0, 0.0, Some(7)).into();
        let [spot] = spots(&alone, [100, 100], 2.0)[..] else { panic!() };
        assert!(spot.owner == 7 && (spot.at[0] - 40.0).abs() <= 2.0 && (spot.at[1] - 40.0).abs() <= 2.0, "{spot:?}");
        assert!((spot.room - 20.0).abs() <= 2.0, "{spot:?}");
        // Something before its left half: the label goes to the right, and what hides has none.
        let half: Vec<Patch> = alone
            .into_iter()
            .chain(square(0.0, 10.0, 60.0, 5.0, None).into_iter().map(|mut patch| {
                patch.corners.iter_mut().for_each(|p| p[0] -= 20.0);
                patch
            }))
            .collect();
        let [spot] = spots(&half, [100, 100], 2.0)[..] else { panic!() };
        assert!(spot.at[0] > 42.0 && spot.at[0] < 58.0, "{spot:?}");
    }

    #[test]
    fn the_roomiest_is_the_first_and_what_is_not_seen_has_none() {
        let patches: Vec<Patch> = [
            square(5.0, 5.0, 10.0, 0.0, Some(1)),
            square(30.0, 30.0, 50.0, 0.0, Some(2)),
            square(40.0, 40.0, 10.0, -1.0, Some(3)),
        ]
        .into_iter()
        .flatten()
        .collect();
        let owners: Vec<i32> = spots(&patches, [90, 90], 1.0).iter().map(|spot| spot.owner).collect();
        assert_eq!(owners, [2, 1]);
    }
}
