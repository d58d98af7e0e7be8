//! Names and colours of the parts of a model, and of a mesh of it.
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a CAD program calls a part, and how it paints it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Label {
    /// The name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The colour as #RRGGBB (sRGB).
    #[serde(default, alias = "color", skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
}

/// Labels by reference: of a model the numbers of its entities from 1, of a mesh the references of its elements.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Names {
    /// Faces.
    pub triangles: BTreeMap<i32, Label>,
    /// Edges.
    pub edges: BTreeMap<i32, Label>,
    /// Solids.
    pub tetrahedra: BTreeMap<i32, Label>,
}

impl Names {
    /// Whether nothing has a label.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.edges.is_empty() && self.tetrahedra.is_empty()
    }
}

/// The references that have a name.
pub fn called(labels: &BTreeMap<i32, Label>, name: &str) -> Vec<i32> {
    let same = |label: &Label| label.name.as_deref() == Some(name);
    labels.iter().filter(|(_, label)| same(label)).map(|(&reference, _)| reference).collect()
}
