//! The fields of a flow at the cells, as they stand in the folder of a step.
use crate::formats::foam::{self, CellField};
use crate::mesh::io::FieldKind;
use std::path::Path;

/// Pressure and temperature, shape (cells), and velocity, shape (cells, 3), in the units of the flow.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    pub pressure: Vec<f64>,
    pub temperature: Vec<f64>,
    pub velocity: Vec<f64>,
}

impl State {
    /// Reads the fields of a folder.
    ///
    /// # Errors
    /// When one is not there or not whole, or a temperature is not positive.
    pub fn read(time: &Path, cells: usize) -> Result<Self, String> {
        let temperature = field(time, "T", cells)?;
        if let Some(value) = temperature.iter().find(|value| **value <= 0.0) {
            return Err(format!("{}: a temperature is {value}", time.display()));
        }
        Ok(Self { pressure: field(time, "p", cells)?, temperature, velocity: field(time, "U", cells)? })
    }

    /// Writes the values of the cells alone, to be read again.
    ///
    /// # Errors
    /// When that cannot be.
    pub fn write(&self, folder: &Path) -> Result<(), String> {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let fields = [
            ("p", FieldKind::Scalar, &self.pressure),
            ("T", FieldKind::Scalar, &self.temperature),
            ("U", FieldKind::Vector, &self.velocity),
        ];
        for (name, kind, values) in fields {
            let field = CellField { kind, values: values.clone() };
            foam::write_cell_field(&folder.join(name), &field, self.pressure.len(), &[], false)
                .map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    /// Each value.
    pub fn values_mut(&mut self) -> impl Iterator<Item = &mut f64> {
        self.pressure.iter_mut().chain(&mut self.temperature).chain(&mut self.velocity)
    }

    /// Each value, in the same order.
    pub fn values(&self) -> impl Iterator<Item = &f64> {
        self.pressure.iter().chain(&self.temperature).chain(&self.velocity)
    }
}

/// The values of a field of a folder.
pub fn field(time: &Path, name: &str, cells: usize) -> Result<Vec<f64>, String> {
    match foam::read_cell_field(&time.join(name), cells) {
        Ok(Ok(field)) => Ok(field.values),
        Ok(Err(class)) => Err(format!("{}: a {class} where a field of cells should be", time.join(name).display())),
        Err(error) => Err(error.to_string()),
    }
}
