//! What comes with a mesh: metric, fields, names, distances from a model.
use super::Arguments;
use super::figures::{edges_of, figures, row};
use crate::cli::files::reading::{self, Carrier};
use crate::cli::metric::common::{self, Failure};
use crate::cli::table::figure;
use crate::formats::{Dataset, NamedField};
use crate::geometry::{Model, classify, fidelity, names};
use crate::mesh::TetMesh;
use crate::mesh::io::{FieldKind, Read, read_solution_on};
use crate::metric::{Field, Statistics, Sym3};
use crate::tasks::{GRAIN, Team};
use crate::view::{Given, NamesFile, ScalarField, Velocity};
use std::path::{Path, PathBuf};

impl Arguments {
    /// Reads and measures what comes with the mesh.
    pub(super) fn given(&self, team: Team<'_>, data: &Dataset) -> Result<Given, Failure> {
        let (mesh, of) = (&data.mesh, Carrier::of(&self.mesh, data));
        let logs = self.logs(team, of)?;
        let metrics = logs.as_ref().map(|logs| team.map(GRAIN, logs.len(), |v| logs[v].exp()));
        let statistics = match &metrics {
            Some(metrics) => Statistics::in_metric(team, mesh, metrics),
            None => Statistics::in_space(team, mesh),
        };
        let mut figures = figures(&statistics);
        let (mut fields, mut velocity) = (Vec::new(), None);
        for path in &self.field {
            let found = self.read_field(team, path, of)?;
            fields.extend(scalars(team, &found));
            velocity = velocity.or_else(|| first_vector(&found));
        }
        if self.field.is_empty() {
            fields = scalars(team, &data.fields);
            velocity = first_vector(&data.fields);
        }
        let mut model_edges = Vec::new();
        if let Some(model) = self.surface.model_or(team, self.cad.as_deref())? {
            model_edges = edges_of(&model);
            fields.push(self.distances(team, mesh, &model, &mut figures));
        }
        let names = data.names.clone();
        let file =
            names::beside(&self.mesh).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let names_file = NamesFile { file, names: names.clone(), fields: names::read_fields(&self.mesh)? };
        Ok(Given { logs, fields, velocity, names, names_file, model_edges, figures, ..Given::default() })
    }

    /// The metric beside the mesh: the file of tensors of the same name, as `adapt` writes it. It measures shapes unless another is given.
    pub(super) fn metric_beside(&self) -> Option<PathBuf> {
        let is_asked = self.metric.is_none() && self.analytic.is_none();
        let beside = ["solb", "sol"].map(|ending| self.mesh.with_extension(ending));
        beside.into_iter().find(|path| is_asked && path.is_file())
    }

    /// ln M at the vertices, when there is a metric.
    fn logs(&self, team: Team<'_>, of: Carrier<'_>) -> Result<Option<Vec<Sym3>>, Failure> {
        let vertices = of.vertices.len();
        match &self.metric {
            Some(path) if path.as_os_str() == "none" => return Ok(None),
            Some(path) => return common::logs(&self.run, team, path, of).map(Some),
            None => {}
        }
        if let Some(field) = self.analytic {
            return Ok(Some(team.map(GRAIN, vertices, |v| field.log_at(of.vertices[v]))));
        }
        let Some(path) = self.metric_beside() else { return Ok(None) };
        // What lies beside a mesh may be its solution, or be left from an older one: then it is no metric of it.
        let Ok(solution) = read_solution_on(team, &path) else { return Ok(None) };
        let is_tensor = matches!(&solution.content.fields[..], [one] if one.kind == FieldKind::SymmetricTensor);
        if !is_tensor || solution.content.vertices != vertices {
            return Ok(None);
        }
        let name = path.display();
        match Field::read_logs(team, &path, vertices) {
            Ok(read) => {
                self.run.note(&[format!(
                    "shapes are measured in the metric beside the mesh, {name}; --metric none: in space"
                )]);
                Ok(Some(read.content))
            }
            Err(error) => {
                self.run.note(&[format!(
                    "shapes are measured in space, since the file beside the mesh is no metric: {error}"
                )]);
                Ok(None)
            }
        }
    }

    /// The fields that an argument names, with their names.
    fn read_field(&self, team: Team<'_>, path: &Path, of: Carrier<'_>) -> Result<Vec<NamedField>, Failure> {
        let Read { content, notices } = reading::fields(team, path, of)?;
        self.run.note(&notices);
        let (name, found, vertices) = (path.display(), content.solution.vertices, of.vertices.len());
        if found != vertices {
            let message = format!("values at {found} vertices, but the mesh has {vertices}: give a field of this mesh");
            return Err(format!("{name}: {message}").into());
        }
        let count = content.solution.fields.len();
        if count == 0 {
            return Err(format!("{name}: no field at the vertices; a field file holds one or more").into());
        }
        if !content.names.is_empty() {
            return Ok(content.into_named());
        }
        let mut called = names::read_fields(path)?;
        if called.len() != count {
            if !called.is_empty() {
                let (beside, names) = (names::beside(path), called.len());
                self.run.note(&[format!("{}: names {names} fields, but {name} has {count}", beside.display())]);
            }
            let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            called = match count {
                1 => vec![stem],
                _ => (1..=count).map(|number| format!("{stem} {number}")).collect(),
            };
        }
        Ok(reading::Fields { names: called, ..content }.into_named())
    }

    /// Distances of the vertices from what they lie on; where the mesh does not fit the model, from its nearest face.
    fn distances(&self, team: Team<'_>, mesh: &TetMesh, model: &Model, figures: &mut Vec<[String; 2]>) -> ScalarField {
        let distances = match classify::classify(team, mesh, model, &classify::Options::default()) {
            Ok((classification, report)) => {
                self.run.note(&report.notices);
                figures.push(row("on the model", "yes"));
                fidelity::distances(team, mesh, model, &classification)
            }
            Err(error) => {
                self.run.note(&[format!("{}: {error}", self.mesh.display())]);
                figures.push(row("on the model", &format!("no: {error}")));
                fidelity::distances_from_faces(team, mesh, model)
            }
        };
        let greatest = distances.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
        figures.push(row("greatest distance from the model", &figure(greatest)));
        ScalarField::new(team, "distance".into(), team.map(GRAIN, distances.len(), |v| distances[v] as f32))
    }
}

/// What to colour by.
fn scalars(team: Team<'_>, fields: &[NamedField]) -> Vec<ScalarField> {
    fields.iter().map(|field| ScalarField::of_values(team, &field.name, field.kind, &field.values)).collect()
}

/// What streamlines follow: the first vector.
fn first_vector(fields: &[NamedField]) -> Option<Velocity> {
    let field = fields.iter().find(|field| field.kind == FieldKind::Vector)?;
    let values = field.values.as_chunks::<3>().0.iter().map(|u| u.map(|x| x as f32)).collect();
    Some(Velocity { name: field.name.clone(), values })
}
