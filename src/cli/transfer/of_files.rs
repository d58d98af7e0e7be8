//! A transfer from the files, by slices, within so many bytes of memory.
use super::Arguments;
use super::in_memory::components_of;
use super::report::{Overlap, Report, Seconds};
use crate::cli::files::{Outputs, Target, reading};
use crate::cli::metric::common::Failure;
use crate::mesh::io::FieldKind;
use crate::mesh::io::slices::{MeshReader, SolutionReader};
use crate::mesh::ranges::Scratch;
use crate::metric::Field;
use crate::metric::transfer::OfFile;
use crate::tasks::{Team, stage};
use crate::transfer::out_of_core::{self, Error, Linear, Sizes, Transferred, conservative, interpolate};
use std::time::Instant;

/// Bytes in the scratch folder: of a vertex, of one of its values, and of a tetrahedron of the old mesh, which some parts share.
const BYTES: [f64; 3] = [56.0, 16.0, 36.0];

/// Bytes there of a conservative transfer: of a new tetrahedron, of a value on it, and of a value of a new vertex.
const OF_CONSERVATIVE: [f64; 3] = [144.0, 48.0, 32.0];

impl Arguments {
    /// As in memory, by slices.
    pub(super) fn of_files(
        &self,
        team: Team<'_>,
        target: &Target,
        memory: u64,
        start: Instant,
    ) -> Result<(Outputs, Option<Report>), Failure> {
        if target.path().extension().is_none_or(|extension| extension != "solb") {
            let path = target.path().display();
            return Err(
                format!("{path}: with --memory the fields go to a .solb: give -o one, or leave --memory out").into()
            );
        }
        let (old, fields) = (reading::mesh_by_slices(&self.old_mesh)?, self.file_of_fields()?);
        let new = reading::mesh_by_slices(&self.new_mesh)?;
        let (counts, width) = ([old.counts(), new.counts()], if self.metric { 6 } else { fields.width() });
        if fields.vertices() != counts[0].vertices {
            let (name, mesh) = (self.old_fields.display(), self.old_mesh.display());
            return Err(format!(
                "{name}: values at {} vertices, but {mesh} has {}; give the mesh they belong to",
                fields.vertices(),
                counts[0].vertices
            )
            .into());
        }
        let sizes = Sizes::of(memory, team.threads(), width, counts)?;
        let vertices = (counts[0].vertices + counts[1].vertices) as f64;
        let bytes = (BYTES[0] + BYTES[1] * width as f64) * vertices + BYTES[2] * counts[0].tets as f64;
        let bytes = match self.conservative {
            Some(_) => {
                let [of_tet, of_value, of_vertex] = OF_CONSERVATIVE;
                let of_old = BYTES[2] * counts[0].tets as f64;
                let of_vertices = of_vertex * width as f64 * counts[1].vertices as f64;
                bytes + of_old + of_vertices + (of_tet + of_value * width as f64) * counts[1].tets as f64
            }
            None => bytes,
        };
        let scratch = self.memory.scratch(target.path(), bytes)?;
        let read = start.elapsed().as_secs_f64();
        let kinds = if self.metric { vec![FieldKind::SymmetricTensor] } else { fields.kinds().to_vec() };
        let (found, overlap) = self.transferred(team, [&old, &new], &fields, (&sizes, &scratch))?;
        let transferred = start.elapsed().as_secs_f64();
        let mut outputs = Outputs::new();
        let to = outputs.fields_by_slices(target, counts[1].vertices, &kinds)?;
        found.put(team, &to)?;
        to.finish()?;
        stage("written");
        if self.figures.are_not_wanted() {
            return Ok((outputs, None));
        }
        let [(old_volume, before), (new_volume, after)] = found.measure(team)?;
        let corrected = overlap.as_ref().map(|overlap| &overlap.corrected[..]);
        let report = Report {
            method: self.method(),
            vertices: counts.map(|counts| counts.vertices),
            tets: counts.map(|counts| counts.tets),
            outside: found.outside,
            farthest: found.farthest,
            volumes: [old_volume, new_volume],
            values: Report::values(components_of(kinds.into_iter()), [&before, &after], corrected),
            overlap: overlap.as_ref().map(|found| Overlap {
                common_volume: found.common,
                partly_outside: found.partly,
                outside: found.outside,
            }),
            seconds: Seconds { read, transfer: transferred - read, total: start.elapsed().as_secs_f64() },
        };
        Ok((outputs, Some(report)))
    }

    /// The fields of the old mesh.
    fn file_of_fields(&self) -> Result<SolutionReader, Failure> {
        if self.old_fields.extension().is_none_or(|extension| extension != "solb") {
            let name = self.old_fields.display();
            return Err(format!(
                "{name}: with --memory the fields are read from a .solb: give one, or leave --memory out"
            )
            .into());
        }
        let file = SolutionReader::open(&self.old_fields)?;
        self.run.note(file.notices());
        if file.kinds().is_empty() {
            return Err(format!("{}: no field at the vertices", self.old_fields.display()).into());
        }
        if self.metric {
            // So that other files are refused with the same message as in all commands.
            Field::tensors_in(Team::alone(), &file, 0..file.vertices().min(1))?;
        }
        Ok(file)
    }

    fn transferred<'m>(
        &self,
        team: Team<'_>,
        meshes: [&'m MeshReader; 2],
        fields: &SolutionReader,
        by: (&Sizes, &Scratch),
    ) -> Result<(Transferred<'m>, Option<out_of_core::Overlap>), Failure> {
        let found = match self.conservative {
            Some(kept) => conservative(team, meshes, (&Linear(fields), kept.keep()), by)
                .map(|(found, overlap)| (found, Some(overlap))),
            None if self.metric => interpolate(team, meshes, &OfFile(fields), by).map(|found| (found, None)),
            None => interpolate(team, meshes, &Linear(fields), by).map(|found| (found, None)),
        };
        found.map_err(|error| match error {
            Error::Mesh(error) => self.named(&error).into(),
            Error::Field(error) => error as Failure,
            Error::Tetrahedra { mesh, .. } => format!("{}: {error}", self.path(mesh).display()).into(),
            error => error.into(),
        })
    }
}
