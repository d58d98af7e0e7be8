//! What the tetrahedra of a conservative transfer give their vertices, in tables.
use super::conservative::{OF_TET, VALUES};
use super::stored::Stored;
use super::{Error, Sizes};
use crate::mesh::ranges::{BLOCK, Blocks, Classes, Ranged, Scratch, Table, each_range};
use crate::tasks::{GRAIN, Team};
use crate::transfer::balance::{Goal, Medium};
use crate::transfer::conservative::{hull, mean};
use crate::transfer::mass::{joined, part_of_sums};
use crate::transfer::pieces::{NOTHING, OnTet};

/// Tetrahedra whose rows are read at once.
const READ: usize = 1 << 12;

/// Values of all vertices, with what they are corrected by.
pub(super) struct Gathered {
    /// Shape (n, width).
    pub values: Table,
    /// Shape (n, 2·width).
    bounds: Table,
    /// Shape (n, 1).
    weights: Table,
}

/// Adds up what the tetrahedra of each vertex give, in the parts and the order of [`crate::transfer::conservative()`].
pub(super) fn gather(
    team: Team<'_>,
    new: &Stored<'_>,
    (on_tets, nearest): (&Table, &Table),
    (sizes, scratch): (&Sizes, &Scratch),
) -> Result<Gathered, Error> {
    let width = nearest.width();
    let found = Gathered {
        values: Table::new(scratch, width)?,
        bounds: Table::new(scratch, 2 * width)?,
        weights: Table::new(scratch, 1)?,
    };
    let (counts, classes) = (new.counts(), Classes::of(new.counts().vertices));
    let bits = team.chunks(32 * BLOCK, counts.tets, |range| -> Result<Vec<_>, Error> {
        Ok(new.tets(range)?.chunks(BLOCK).map(|block| classes.bits(block)).collect())
    });
    let bits = bits.into_iter().collect::<Result<Vec<_>, _>>()?.concat();
    let blocks = Blocks { classes, size: BLOCK, tets: counts.tets, bits };
    let mut before = 0;
    // A vertex of the range has sums, bounds and values beside.
    let bytes = sizes.waiting / (1 + width / 4);
    each_range(team, new.mesh(), &blocks, bytes, |ranged| -> Result<usize, Error> {
        found.add(before, ranged, (on_tets, nearest))?;
        before += ranged.own.len();
        Ok(0)
    })?;
    Ok(found)
}

/// What is added up at a vertex.
#[derive(Clone, Copy)]
struct Sum {
    /// Of the parts before, and of the part now.
    all: f64,
    part: f64,
}

const ZERO: Sum = Sum { all: 0.0, part: 0.0 };

impl Sum {
    /// Ends a part.
    fn end(&mut self) {
        self.all += self.part;
        self.part = 0.0;
    }
}

impl Gathered {
    /// Adds up what the vertices of a range get, which begins at this vertex.
    fn add(&self, start: usize, ranged: &Ranged, (on_tets, nearest): (&Table, &Table)) -> Result<(), Error> {
        let (width, own) = (nearest.width(), ranged.own.len());
        // The sums of a vertex: its components, then its weight.
        let (mut sums, mut bounds) = (vec![ZERO; (width + 1) * own], vec![NOTHING; width * own]);
        let mut parts = vec![u32::MAX; own];
        for (tets, numbers) in ranged.tets.chunks(READ).zip(ranged.tet_numbers.chunks(READ)) {
            let rows = on_tets.at(numbers)?;
            for ((nodes, &number), row) in tets.iter().zip(numbers).zip(rows.chunks_exact(OF_TET + VALUES * width)) {
                let (volume, components) = (row[0], bytemuck::cast_slice::<f64, OnTet>(&row[OF_TET..]));
                if volume == 0.0 {
                    continue;
                }
                let part = number / GRAIN as u32;
                for (k, &v) in nodes.iter().enumerate().filter(|(_, v)| ranged.own.contains(v)) {
                    let v = (v - ranged.own.start) as usize;
                    let sums = &mut sums[(width + 1) * v..][..width + 1];
                    if parts[v] != part {
                        parts[v] = part;
                        sums.iter_mut().for_each(Sum::end);
                    }
                    sums[width].part += 0.25 * volume;
                    for (c, component) in components.iter().enumerate() {
                        sums[c].part += 0.25 * volume * component.values[k];
                        bounds[v * width + c] = hull(bounds[v * width + c], component.bounds);
                    }
                }
            }
        }
        sums.iter_mut().for_each(Sum::end);
        let nearest = nearest.read(start..start + own)?;
        let (mut values, mut weights) = (vec![0.0; width * own], Vec::with_capacity(own));
        for (v, sums) in sums.chunks_exact(width + 1).enumerate() {
            weights.push(sums[width].all);
            for c in 0..width {
                let at = v * width + c;
                (values[at], bounds[at]) = mean(sums[c].all, sums[width].all, bounds[at], nearest[at]);
            }
        }
        self.values.write(start, &values)?;
        self.bounds.write(start, bounds.as_flattened())?;
        Ok(self.weights.write(start, &weights)?)
    }

    /// A component, to be balanced.
    pub fn component<'g>(&'g self, team: Team<'g>, vertices: usize, component: usize) -> Component<'g> {
        Component { team, vertices, component, all: self }
    }
}

/// A component of the values in tables.
pub(super) struct Component<'g> {
    team: Team<'g>,
    vertices: usize,
    component: usize,
    all: &'g Gathered,
}

impl Component<'_> {
    /// The sums of what `terms` makes of weight, value and bounds of each vertex.
    fn sums<const N: usize>(&self, terms: impl Fn(f64, f64, [f64; 2]) -> [f64; N] + Sync) -> Result<[f64; N], Error> {
        let (Gathered { values, bounds, weights }, c) = (self.all, self.component);
        let width = values.width();
        let parts = self.team.chunks(GRAIN, self.vertices, |range| -> Result<_, Error> {
            let (count, values, weights) = (range.len(), values.read(range.clone())?, weights.read(range.clone())?);
            let bounds = bounds.read(range)?;
            let bounds = bounds.as_chunks::<2>().0;
            Ok(part_of_sums(0..count, N, |v, row| {
                row.copy_from_slice(&terms(weights[v], values[v * width + c], bounds[v * width + c]));
            }))
        });
        let sums = joined(N, parts.into_iter().collect::<Result<Vec<_>, _>>()?);
        Ok(std::array::from_fn(|k| sums[k]))
    }
}

impl Medium for Component<'_> {
    type Error = Error;

    fn masses(&self) -> Result<[f64; 2], Error> {
        self.sums(|weight, value, _| [weight * value, (weight * value).abs()])
    }

    fn room(&self, goal: Goal) -> Result<f64, Error> {
        Ok(self.sums(|weight, value, bounds| [weight * (goal.of(bounds) - value)])?[0])
    }

    fn go(&mut self, goal: Goal, part: f64) -> Result<(), Error> {
        let (Gathered { values, bounds, .. }, c) = (self.all, self.component);
        let width = values.width();
        let parts = self.team.chunks(GRAIN, self.vertices, |range| -> Result<(), Error> {
            let (start, mut rows, bounds) = (range.start, values.read(range.clone())?, bounds.read(range)?);
            for (row, bounds) in rows.chunks_exact_mut(width).zip(bounds.as_chunks::<2>().0.chunks_exact(width)) {
                row[c] = goal.moved(row[c], bounds[c], part);
            }
            Ok(values.write(start, &rows)?)
        });
        parts.into_iter().collect()
    }
}
