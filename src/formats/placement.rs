//! Meshes in other units, or elsewhere.
use super::Dataset;
use crate::mesh::Association;
use crate::mesh::io::FieldKind;

/// What a metric is called among fields.
const METRIC: &str = "metric";

/// A scale about the origin, then a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The factor of lengths, positive.
    pub scale: f64,
    /// In the new unit.
    pub translation: [f64; 3],
}

impl Placement {
    /// Moves a mesh. A metric, which has the unit 1/length², goes with it; other fields keep their values. Places on a model are those of the
    /// model as it was, and are left out. Returns notices of both.
    pub fn apply(&self, data: &mut Dataset) -> Vec<String> {
        let Self { scale, translation } = *self;
        for point in &mut data.mesh.vertices {
            *point = std::array::from_fn(|k| scale * point[k] + translation[k]);
        }
        let mut notices = Vec::new();
        let on = std::mem::take(&mut data.mesh.association);
        if on != Association::default() {
            notices.push("the places on the model are left out: it is another one now".into());
        }
        if scale == 1.0 {
            return notices;
        }
        for field in &mut data.fields {
            if field.kind == FieldKind::SymmetricTensor && field.name == METRIC {
                field.values.iter_mut().for_each(|value| *value /= scale * scale);
                notices.push(format!("the field {METRIC} is in the new unit too"));
            } else {
                notices.push(format!("the field {} keeps its values", super::error::short(&field.name)));
            }
        }
        notices
    }
}
