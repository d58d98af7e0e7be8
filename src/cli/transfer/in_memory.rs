//! A transfer in memory.
use super::Arguments;
use super::report::{Overlap, Report, Seconds};
use crate::cli::files::reading::{self, Carrier, Fields};
use crate::cli::files::{Outputs, Target};
use crate::cli::metric::common::{self, Failure};
use crate::formats::Dataset;
use crate::mesh::adjacency::MatchedFaces;
use crate::mesh::io::{FieldKind, Read, Solution, SolutionField};
use crate::mesh::locate::Locator;
use crate::metric::Field;
use crate::metric::transfer::tensors_at;
use crate::tasks::{GRAIN, Team, stage};
use crate::transfer::{Conserved, Places, conservative, interpolate, measure};
use std::sync::Arc;
use std::time::Instant;

impl Arguments {
    /// Reads all, transfers it and writes it.
    pub(super) fn in_memory(
        &self,
        team: Team<'_>,
        target: &Target,
        start: Instant,
    ) -> Result<(Outputs, Option<Report>), Failure> {
        let old = common::mesh(&self.run, team, &self.old_mesh)?;
        let fields = self.fields(team, &old)?;
        let (old, fields, called) = (old.mesh, fields.solution, fields.names);
        let to_mesh = common::mesh(&self.run, team, &self.new_mesh)?;
        let new = &to_mesh.mesh;
        let read = start.elapsed().as_secs_f64();
        stage("read");
        let faces = MatchedFaces::of(team, &old.tets.nodes);
        let locator = Locator::on(team, Arc::new(old), faces);
        let places = Places::of(team, &locator, &new.vertices);
        stage("located");
        let width = fields.fields.iter().map(|field| field.kind.values()).sum();
        let rows = rows(team, &fields, width);
        let (found, conserved) = match self.conservative {
            Some(kept) => {
                let found = conservative(team, &locator, new, &places, width, &rows, kept.keep());
                let Conserved { values, .. } = found.as_ref().map_err(|error| self.named(error))?;
                (values.clone(), found.ok())
            }
            None if self.metric => (tensors_at(team, &locator, &places, rows.as_chunks().0).into_flattened(), None),
            None => (interpolate(team, &locator, &places, width, &rows), None),
        };
        let transferred = start.elapsed().as_secs_f64();
        stage("transferred");
        let mut outputs = Outputs::new();
        let transferred_fields = Fields { solution: solution(team, &fields, width, &found), names: called, mesh: None };
        self.run.note(&outputs.fields(team, target, transferred_fields, common::on(&to_mesh))?);
        stage("written");
        let (old_volume, before) = measure(team, locator.mesh(), width, &rows);
        let (new_volume, after) = measure(team, new, width, &found);
        let corrected = conserved.as_ref().map(|conserved| &conserved.corrected[..]);
        let report = Report {
            method: self.method(),
            vertices: [locator.vertices().len(), new.vertices.len()],
            tets: [locator.tets().len(), new.tets.len()],
            outside: places.outside,
            farthest: places.farthest,
            volumes: [old_volume, new_volume],
            overlap: conserved.as_ref().map(|found| Overlap {
                common_volume: found.common,
                partly_outside: found.partly,
                outside: found.outside,
            }),
            values: Report::values(components(&fields), [&before, &after], corrected),
            seconds: Seconds { read, transfer: transferred - read, total: start.elapsed().as_secs_f64() },
        };
        Ok((outputs, Some(report)))
    }

    /// Reads the fields of the old mesh.
    fn fields(&self, team: Team<'_>, old: &Dataset) -> Result<Fields, Failure> {
        let of = Carrier::of(&self.old_mesh, old);
        if !self.metric {
            return common::fields(&self.run, team, &self.old_fields, of);
        }
        // Read as a metric, so that other files are refused with the same message as in all commands.
        let Read { content: mut fields, notices } = reading::metric(team, &self.old_fields, of)?;
        let vertices = Some(of.vertices.len());
        let logs = Field::logs_of_solution(team, &self.old_fields, &fields.solution, vertices)?;
        self.run.note(&[notices, logs.notices].concat());
        if fields.solution.fields[0].kind == FieldKind::Scalar {
            // Isotropic sizes: their tensors are interpolated.
            fields.solution = Field::solution_of_logs(team, &self.old_fields, &logs.content)?;
        }
        Ok(fields)
    }
}

/// Number of the field and of the component in it, each from 1, of each value of a vertex.
pub(in crate::cli) fn components(solution: &Solution) -> impl Iterator<Item = (usize, usize)> {
    components_of(solution.fields.iter().map(|field| field.kind))
}

/// The same of fields of these kinds.
pub(super) fn components_of(kinds: impl Iterator<Item = FieldKind>) -> impl Iterator<Item = (usize, usize)> {
    kinds.zip(1..).flat_map(|(kind, number)| (1..=kind.values()).map(move |k| (number, k)))
}

/// All fields in rows of `width` values a vertex.
pub(in crate::cli) fn rows(team: Team<'_>, solution: &Solution, width: usize) -> Vec<f64> {
    let mut rows = vec![0.0; width * solution.vertices];
    team.fill(width * GRAIN, &mut rows, |start, rows| {
        for (row, v) in rows.chunks_exact_mut(width).zip(start / width..) {
            let mut to = row;
            for field in &solution.fields {
                let (here, rest) = to.split_at_mut(field.kind.values());
                here.copy_from_slice(&field.values[v * here.len()..][..here.len()]);
                to = rest;
            }
        }
    });
    rows
}

/// The fields of these kinds, from rows of `width` values a vertex.
fn solution(team: Team<'_>, like: &Solution, width: usize, rows: &[f64]) -> Solution {
    let mut first = 0;
    let mut fields = Vec::with_capacity(like.fields.len());
    for field in &like.fields {
        let count = field.kind.values();
        let from = first;
        let value = |at: usize| rows[at / count * width + from + at % count];
        fields.push(SolutionField { kind: field.kind, values: team.map(GRAIN, rows.len() / width * count, value) });
        first += count;
    }
    Solution { vertices: rows.len() / width, fields }
}
