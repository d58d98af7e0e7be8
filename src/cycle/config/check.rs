//! Refuses configurations whose keys are each allowed, but not together, before the loop begins.
use super::{Config, FIRST, Growth, Loaded, NormWord};
use crate::cycle::field_value::{Value, flow_values, values_of};
use crate::metric::multiscale::Norm;
use crate::sizing::layer::Walls;
use crate::view::cut::Plane;
use std::path::Path;

impl Loaded {
    /// Refuses what would fail later; messages begin with the table and the key.
    pub(super) fn check(&self) -> Result<(), String> {
        self.check_mesh()?;
        self.check_metric()?;
        self.check_schedule()?;
        self.check_goal()?;
        self.check_names()?;
        let adapt = &self.config.adapt;
        if adapt.processes == Some(0) || adapt.threads == Some(0) {
            return Err("[adapt] processes and threads: give 1 or more".into());
        }
        if adapt.scratch.is_some() && adapt.memory.is_none() {
            return Err("[adapt] scratch belongs to memory, which says what does not fit: give both, or none".into());
        }
        let output = &self.config.output;
        if let Some(cut) = &output.cut {
            cut.parse::<Plane>().map_err(|error| format!("[output] cut: {error}"))?;
        }
        if output.view.is_some_and(|[_, elevation]| !(-90.0..=90.0).contains(&elevation)) {
            return Err("[output] view: give azimuth and elevation in degrees, the elevation from -90 to 90".into());
        }
        positive("[output] zoom", output.zoom)
    }

    fn check_mesh(&self) -> Result<(), String> {
        let mesh = &self.config.mesh;
        let given = [mesh.file.is_some(), mesh.bootstrap.is_some(), mesh.cube.is_some()];
        if given.iter().filter(|&&given| given).count() != 1 {
            return Err(
                "[mesh]: give one of file (a mesh), bootstrap (a model to make one of) and cube (cells along an edge)"
                    .into(),
            );
        }
        if mesh.bootstrap.is_none() && (mesh.far_field.is_some() || mesh.symmetry.is_some() || !mesh.options.is_empty())
        {
            return Err("[mesh] far_field, symmetry and options belong to bootstrap: leave them out without it".into());
        }
        if mesh.bootstrap.is_some() && mesh.cad.is_some() {
            return Err("[mesh] cad belongs to file: bootstrap's own model is the model".into());
        }
        if mesh.surface.is_some() && (mesh.bootstrap.is_some() || mesh.cad.is_some()) {
            return Err("[mesh] surface belongs to file, and stands instead of cad: leave one of them out".into());
        }
        if mesh.cube.is_some_and(|cells| !(1..=100).contains(&cells)) {
            return Err("[mesh] cube: give 1 to 100 cells along an edge".into());
        }
        for (key, path) in [("[mesh] file", &mesh.file), ("[mesh] bootstrap", &mesh.bootstrap)] {
            path.as_deref().map_or(Ok(()), |path| self.check_file(key, path))?;
        }
        if let Some(surface) = mesh.surface.as_deref().filter(|surface| *surface != Path::new(FIRST)) {
            self.check_file("[mesh] surface", surface)?;
        }
        mesh.cad.as_deref().map_or(Ok(()), |cad| self.check_file("[mesh] cad", cad))
    }

    fn check_file(&self, key: &str, path: &Path) -> Result<(), String> {
        let found = self.at(path);
        if found.is_file() {
            Ok(())
        } else {
            Err(format!("{key}: there is no file {}; relative paths begin at the folder of this file", found.display()))
        }
    }

    fn check_metric(&self) -> Result<(), String> {
        let metric = &self.config.metric;
        if let Some(norm) = &metric.norm {
            norm.to_string().parse::<Norm>().map_err(|error| format!("[metric] norm: {error}"))?;
            if matches!(norm, NormWord::Word(word) if word != "inf") {
                return Err("[metric] norm: give a number from 1 on, or \"inf\"".into());
            }
        }
        match &metric.gradation {
            Some(Growth::Number(ratio)) if !(ratio.is_finite() && *ratio > 1.0) => {
                return Err(format!("[metric] gradation = {ratio}: give a number above 1, such as 1.5, or \"off\""));
            }
            Some(Growth::Word(word)) if word != "off" => {
                return Err(format!("[metric] gradation = '{word}': give a number above 1, such as 1.5, or \"off\""));
            }
            _ => {}
        }
        for (key, value) in [
            ("[metric] hmin", metric.hmin),
            ("[metric] hmax", metric.hmax),
            ("[metric] segments", metric.segments),
            ("[metric] feature_cells", metric.feature_cells),
        ] {
            positive(key, value)?;
        }
        if let (Some(least), Some(greatest)) = (metric.hmin, metric.hmax)
            && least > greatest
        {
            return Err(format!(
                "[metric] hmin {least} is above hmax {greatest}: give a least size below the greatest"
            ));
        }
        if metric.aspect_ratio.is_some_and(|ratio| !(ratio.is_finite() && ratio >= 1.0)) {
            return Err("[metric] aspect_ratio: give 1 or more".into());
        }
        for wall in &metric.walls {
            wall.parse::<Walls>().map_err(|error| format!("[metric] walls: {error}"))?;
        }
        let mesh = &self.config.mesh;
        if metric.geometry == Some(true) && mesh.cad.is_none() && mesh.bootstrap.is_none() && mesh.surface.is_none() {
            return Err("[metric] geometry = true needs a model: give [mesh] cad, surface, or bootstrap".into());
        }
        if metric.geometry == Some(false) && (metric.segments.is_some() || metric.feature_cells.is_some()) {
            return Err(
                "[metric] segments and feature_cells belong to the geometry, which geometry = false leaves out".into(),
            );
        }
        Ok(())
    }

    fn check_goal(&self) -> Result<(), String> {
        let Config { goal, metric, schedule, .. } = &self.config;
        let Some(goal) = goal else {
            return match schedule.until {
                Some(_) => Err("[schedule] until asks for the error in a goal: give a [goal] with an estimate".into()),
                None => Ok(()),
            };
        };
        if !metric.fields.is_empty() {
            return Err("[metric] fields: the metric is that of the [goal]: leave fields out, or the goal".into());
        }
        goal.check()?;
        let of_solver = self.config.solver.solver().flow();
        goal.flow(of_solver.as_ref())?;
        match &schedule.until {
            Some(until) if until.functional != goal.functional => Err(format!(
                "[schedule] until: the goal is {}, not {}: give \"error({}) < {}\"",
                goal.functional, until.functional, goal.functional, until.below
            )),
            Some(_) if goal.estimate.is_none() => {
                Err("[schedule] until needs an estimate of the goal: give [goal] estimate, what the solver calls it"
                    .into())
            }
            _ => Ok(()),
        }
    }

    /// Refuses names that the solver does not have, as far as it is known what it has before it runs.
    fn check_names(&self) -> Result<(), String> {
        let config = &self.config;
        let solver = config.solver.solver();
        if let Some(fields) = solver.fields() {
            values_of(&config.metric.fields, &fields)?;
            if let Some(goal) = &config.goal {
                goal.terms(Path::new(""), &fields)?;
                let of_solver = solver.flow();
                goal.flow(of_solver.as_ref())?.map_or(Ok(()), |flow| flow_values(flow, &fields).map(drop))?;
            }
            for (name, probe) in &config.probes {
                Value::find(&probe.field, &fields).map_err(|error| format!("[probes] {name}: {error}"))?;
            }
        }
        if let (Some(converged), Some(mut known)) = (&config.schedule.converged, solver.functionals()) {
            known.extend(config.probes.keys().cloned());
            if !known.contains(&converged.functional) {
                let (wanted, known) =
                    (&converged.functional, if known.is_empty() { "none".into() } else { known.join(", ") });
                return Err(format!(
                    "[schedule.converged] functional: the solver tells no '{wanted}'; it tells {known}"
                ));
            }
        }
        Ok(())
    }

    fn check_schedule(&self) -> Result<(), String> {
        let schedule = &self.config.schedule;
        positive("[schedule] complexity", Some(schedule.complexity))?;
        positive("[schedule] max_complexity", schedule.max_complexity)?;
        if !(schedule.factor.is_finite() && schedule.factor >= 1.0) {
            return Err(format!("[schedule] factor = {}: give 1 or more, such as 2", schedule.factor));
        }
        if schedule.every == 0 || schedule.cycles == Some(0) {
            return Err("[schedule] every and cycles: give 1 or more".into());
        }
        if schedule.max_complexity.is_some_and(|most| most < schedule.complexity) {
            return Err("[schedule] max_complexity is below complexity, with which the loop begins".into());
        }
        if let Some(converged) = &schedule.converged {
            positive("[schedule.converged] change", Some(converged.change))?;
            if converged.cycles == 0 {
                return Err("[schedule.converged] cycles: give 1 or more".into());
            }
        }
        let grows = schedule.factor > 1.0 && schedule.max_complexity.is_some();
        if schedule.cycles.is_none() && !grows {
            return Err(
                "[schedule] nothing ends this loop for certain: give cycles, or max_complexity with a factor above 1"
                    .into(),
            );
        }
        Ok(())
    }
}

fn positive(key: &str, value: Option<f64>) -> Result<(), String> {
    match value {
        Some(value) if !(value.is_finite() && value > 0.0) => Err(format!("{key} = {value}: give a positive number")),
        _ => Ok(()),
    }
}
