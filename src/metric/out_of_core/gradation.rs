//! Gradation of metrics in a scratch folder: what a round needs of them is read, and what it changes is written back.
use super::mesh::Mesh;
use super::{Error, each_slice};
use crate::mesh::ranges::{Column, Numbering};
use crate::mesh::vector::Vec3;
use crate::metric::Sym3;
use crate::metric::frame::Frame;
use crate::metric::gradation::Graded;
use crate::metric::gradation::edges::Known;
use crate::metric::gradation::front::{Front, Metrics, Update};
use crate::tasks::Team;

/// Vertices a task, with their neighbours a megabyte or a few.
const VERTICES: usize = 1 << 11;

/// Grades ln M at the vertices by a ratio r > 1, to the bit as [`grade_with`](crate::metric::gradation::grade_with).
pub(super) fn grade(team: Team<'_>, mesh: &Mesh, logs: &Column<Sym3>, ratio: f64) -> Result<Graded, Error> {
    Front::new(team, mesh.vertices, InFiles { team, mesh, logs, growth: ratio.ln() }).run(|_, _| true)
}

/// ln M at the vertices of a mesh.
struct InFiles<'a> {
    team: Team<'a>,
    mesh: &'a Mesh,
    logs: &'a Column<Sym3>,
    growth: f64,
}

/// What is known of some vertices.
struct Here {
    numbering: Numbering,
    points: Vec<Vec3>,
    logs: Vec<Sym3>,
    frames: Vec<Frame>,
}

impl InFiles<'_> {
    fn read(&self, vertices: impl Iterator<Item = u32>) -> Result<Here, Error> {
        let numbering = Numbering::of(vertices);
        let points = self.mesh.points.at(&numbering.numbers)?;
        let logs = self.logs.at(&numbering.numbers)?;
        let frames = logs.iter().map(Frame::of_log).collect();
        Ok(Here { numbering, points, logs, frames })
    }

    fn known<'h>(&self, here: &'h Here) -> Known<'h> {
        Known { points: &here.points, frames: &here.frames, growth: self.growth }
    }
}

impl Metrics for InFiles<'_> {
    type Error = Error;

    fn violators(&self, is_open: impl Fn(u32, u32) -> bool + Sync) -> Result<Vec<(u32, f64)>, Error> {
        let found = each_slice(self.team, VERTICES, self.mesh.vertices, |range| {
            let vertices: Vec<u32> = (range.start as u32..range.end as u32).collect();
            let around = self.mesh.neighbours.around(&vertices)?;
            // Vertices with the ends of their open edges.
            let open = vertices.iter().zip(around.rows()).map(|(&p, row)| {
                let is_open = &is_open;
                (p, row.iter().copied().filter(move |&q| is_open(p, q)))
            });
            let with_ends = open.clone().flat_map(|(p, ends)| ends.flat_map(move |q| [p, q]));
            let here = self.read(with_ends)?;
            let (known, place) = (self.known(&here), |v: u32| here.numbering.place(v));
            let mut violators = Vec::new();
            for (p, mut ends) in open {
                if let Some(first) = ends.next() {
                    let ends = std::iter::once(first).chain(ends).map(place);
                    violators.extend(known.least_excess(place(p), ends).map(|least| (p, least)));
                }
            }
            Ok(violators)
        })?;
        Ok(self.team.join(found))
    }

    fn each_neighbour(&self, sources: &[u32], tell: impl Fn(u32) + Sync) -> Result<(), Error> {
        let mut ascending = sources.to_vec();
        ascending.sort_unstable();
        each_slice(self.team, VERTICES, ascending.len(), |range| {
            self.mesh.neighbours.around(&ascending[range])?.entries.iter().for_each(|&q| tell(q));
            Ok(())
        })?;
        Ok(())
    }

    fn updated(&self, targets: &[u32], is_source: impl Fn(u32) -> bool + Sync) -> Result<Vec<Update>, Error> {
        let found = each_slice(self.team, VERTICES, targets.len(), |range| {
            let targets = &targets[range];
            let around = self.mesh.neighbours.around(targets)?;
            let is_source = |v: &u32| is_source(*v);
            let here = self.read(targets.iter().copied().chain(around.entries.iter().copied().filter(is_source)))?;
            let (known, place) = (self.known(&here), |v: u32| here.numbering.place(v));
            let updated = targets.iter().zip(around.rows()).filter_map(|(&vertex, row)| {
                let q = place(vertex);
                let sources = row.iter().copied().filter(is_source).map(place);
                let (log, least_changed) = known.updated(q, &here.logs[q as usize], sources)?;
                Some(Update { vertex, log, least_changed })
            });
            Ok(updated.collect::<Vec<Update>>())
        })?;
        Ok(self.team.join(found))
    }

    fn replace(&mut self, updates: &[Update]) -> Result<(), Error> {
        each_slice(self.team, VERTICES, updates.len(), |range| {
            let (vertices, logs): (Vec<u32>, Vec<Sym3>) = updates[range].iter().map(|u| (u.vertex, u.log)).unzip();
            Ok(self.logs.replace(&vertices, &logs)?)
        })?;
        Ok(())
    }
}
