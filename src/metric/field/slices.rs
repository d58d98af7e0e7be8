//! Metric files larger than memory: read and written by ranges of vertices.
use super::{Field, check_count, checked_log, held, held_exp, of_vertices, only_metric, tensors};
use crate::mesh::io::FieldKind;
use crate::mesh::io::slices::{MetricWriter, SolutionReader};
use crate::metric::{Error, Sym3};
use crate::tasks::Team;
use std::ops::Range;
use std::path::Path;

impl Field {
    /// Opens a .solb file of a mesh of so many vertices, as [`Field::read`] has it, for [`Field::logs_in`].
    ///
    /// # Errors
    /// When the file cannot be read or is a text, [`Error::Kind`] when it holds no metric, [`Error::Count`] for another number of vertices.
    pub fn open(path: &Path, vertices: usize) -> Result<SolutionReader, Error> {
        let file = SolutionReader::open(path)?;
        only_metric(path, file.kinds())?;
        check_count(path, file.vertices(), Some(vertices))?;
        Ok(file)
    }

    /// ln M, shape (n,), at these vertices of a file of M, or of sizes, to the last bit as [`Field::read_logs`] has it.
    ///
    /// # Errors
    /// When the file cannot be read or holds no metric, [`Error::NotPositive`] and [`Error::NotASize`] with the vertex's number in the file.
    pub fn logs_in(team: Team<'_>, file: &SolutionReader, range: Range<usize>) -> Result<Vec<Sym3>, Error> {
        only_metric(file.path(), file.kinds())?;
        let start = range.start;
        let solution = file.fields(team, range)?;
        of_vertices(team, file.path(), &solution, start, checked_log)
    }

    /// M, shape (n,), at these vertices, as [`Field::read`] has it and with the checks of [`Field::logs_in`].
    ///
    /// # Errors
    /// As there.
    pub fn metrics_in(team: Team<'_>, file: &SolutionReader, range: Range<usize>) -> Result<Vec<Sym3>, Error> {
        only_metric(file.path(), file.kinds())?;
        let start = range.start;
        let solution = file.fields(team, range)?;
        of_vertices(team, file.path(), &solution, start, |m| m.is_spd().then_some(m))
    }

    /// M, shape (n, 6), at these vertices, with the checks of [`Field::logs_in`]: tensors to the last bit as the file has them, and those of sizes as
    /// [`Field::solution_of_logs`] has them.
    ///
    /// # Errors
    /// As there, and [`Error::NotHeld`] for a size whose tensor is not positive definite in doubles.
    pub fn tensors_in(team: Team<'_>, file: &SolutionReader, range: Range<usize>) -> Result<Vec<[f64; 6]>, Error> {
        let (kind, start) = (only_metric(file.path(), file.kinds())?, range.start);
        let solution = file.fields(team, range)?;
        let logs = of_vertices(team, file.path(), &solution, start, checked_log)?;
        match kind {
            FieldKind::Scalar => tensors(team, file.path(), start, &logs, held_exp),
            _ => Ok(solution.fields[0].values.as_chunks().0.to_vec()),
        }
    }

    /// Writes metrics, shape (n,), from vertex `start` (from 0) on.
    ///
    /// # Errors
    /// When the file cannot be written, and [`Error::NotHeld`] when a tensor is not positive definite in doubles.
    pub fn put(team: Team<'_>, file: &MetricWriter, start: usize, metrics: &[Sym3]) -> Result<(), Error> {
        Ok(file.put(team, start, &tensors(team, file.path(), start, metrics, held)?)?)
    }

    /// As [`Field::put`], M = exp of these logarithms.
    ///
    /// # Errors
    /// As there.
    pub fn put_logs(team: Team<'_>, file: &MetricWriter, start: usize, logs: &[Sym3]) -> Result<(), Error> {
        Ok(file.put(team, start, &tensors(team, file.path(), start, logs, held_exp)?)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::io::{self, Solution, SolutionField};
    use std::fs::{self, File};

    #[test]
    fn a_metric_by_slices_is_that_of_the_whole_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let metrics: Vec<_> = (1..=9).map(|v| Sym3::diagonal(f64::from(v), 0.3, 1e6)).collect();
        let logs: Vec<_> = metrics.iter().map(Sym3::ln).collect();
        Field { metrics: metrics.clone() }.write(&path("whole.solb")).unwrap();
        Field::write_logs(Team::alone(), &path("of_logs.solb"), &logs).unwrap();
        let writer = |name: &str| MetricWriter::create(File::create(path(name)).unwrap(), &path(name), 9).unwrap();
        let (by_metrics, by_logs) = (writer("a.solb"), writer("b.solb"));
        for range in [4..9, 0..4] {
            Field::put(Team::alone(), &by_metrics, range.start, &metrics[range.clone()]).unwrap();
            Field::put_logs(Team::alone(), &by_logs, range.start, &logs[range]).unwrap();
        }
        by_metrics.finish().unwrap();
        by_logs.finish().unwrap();
        let bytes = |name: &str| fs::read(path(name)).unwrap();
        assert_eq!((bytes("a.solb"), bytes("b.solb")), (bytes("whole.solb"), bytes("of_logs.solb")));
        let whole = Field::read_logs(Team::alone(), &path("a.solb"), 9).unwrap().content;
        let file = Field::open(&path("a.solb"), 9).unwrap();
        assert_eq!(Field::logs_in(Team::alone(), &file, 2..7).unwrap(), whole[2..7]);
        assert_eq!(Field::metrics_in(Team::alone(), &file, 2..7).unwrap(), metrics[2..7]);
        let tensors: Vec<_> = metrics[2..7].iter().map(|m| m.0).collect();
        assert_eq!(Field::tensors_in(Team::alone(), &file, 2..7).unwrap(), tensors);
        let message = Field::open(&path("a.solb"), 8).unwrap_err().to_string();
        assert!(message.contains("metric at 9 vertices, but the mesh has 8"), "{message}");
    }

    #[test]
    fn errors_name_the_vertex_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.solb");
        let message = |values: &[f64], kind, range: Range<usize>| {
            let vertices = values.len() / FieldKind::values(kind);
            let fields = vec![SolutionField { kind, values: values.to_vec() }];
            io::write_solution(&path, &Solution { vertices, fields }).unwrap();
            let file = Field::open(&path, vertices)?;
            Field::logs_in(Team::alone(), &file, range).map(|_| ())
        };
        let sizes = [1.0, 1.0, 1.0, -1.0];
        assert!(message(&sizes, FieldKind::Scalar, 0..3).is_ok());
        let said = message(&sizes, FieldKind::Scalar, 2..4).unwrap_err().to_string();
        assert!(said.contains("the size of vertex 4 is -1"), "{said}");
        let tensors = [[1.0, 0.0, 1.0, 0.0, 0.0, 1.0], [1.0, 2.0, 1.0, 0.0, 0.0, 1.0]].concat();
        let said = message(&tensors, FieldKind::SymmetricTensor, 1..2).unwrap_err().to_string();
        assert!(said.contains("metric of vertex 2 is not positive definite"), "{said}");
        let said = message(&[0.0; 6], FieldKind::Vector, 0..1).unwrap_err().to_string();
        assert!(said.contains("fields: vector"), "{said}");
        let writer = MetricWriter::create(File::create(&path).unwrap(), &path, 9).unwrap();
        let metrics = [Sym3::IDENTITY, Sym3::ZERO];
        let said = Field::put(Team::alone(), &writer, 5, &metrics).unwrap_err();
        assert!(matches!(said, Error::NotHeld { vertex: 7, .. }), "{said}");
    }
}
