//! How much the passes do: all that a unit mesh takes, or less for a draft. A draft serves only to find the sizes of the next mesh.

/// How much the passes do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Whether there are stages. They save insertions in thin layers; a first mesh is too coarse everywhere, and there they only take time.
    pub stages: bool,
    /// Whether edges wait for flips, as [`Limits::waits`](crate::adapt::core::context::Limits::waits) says. From a first mesh, which has no
    /// vertex inside, that halves the insertions; a mesh that is good already gets no better, and takes more sweeps.
    pub waits: bool,
    /// A pass for the sizes that changes less than this share of the vertices is the last.
    pub little: f64,
    /// So is one that changes less than this share, where the mesh has nearly all vertices that are expected and most insertions were refused: what
    /// is still too long has no room between the others, until these are smoothed.
    pub crowded: f64,
    /// A pass for the shapes that saves less than this share of the mean of 1/Q − 1 is the last.
    pub settled: f64,
    /// Whether there are passes for the shapes once all vertices are on the model.
    pub shapes: bool,
    /// Whether the worst tetrahedra are repaired one by one.
    pub repairs: bool,
}

impl Effort {
    /// For a unit mesh.
    pub const FULL: Self =
        Self { stages: true, waits: false, little: 0.05, crowded: 0.12, settled: 0.14, shapes: true, repairs: true };

    /// Between cuts that will move: what is bad beside them waits until then.
    pub const BETWEEN_CUTS: Self = Self { repairs: false, ..Self::FULL };

    /// Around cuts that have moved: a quarter or so is at one, the rest is good already, and what a pass saves is a share of the cost of both.
    pub const AROUND_CUTS: Self = Self { settled: 0.05, ..Self::FULL };

    /// For a draft.
    pub const DRAFT: Self =
        Self { stages: false, waits: true, little: 0.1, crowded: 0.1, settled: 0.14, shapes: false, repairs: true };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adapt::schedule::work::Kind;
    use crate::adapt::tests::bench::{Bench, Sample, Shape, sample};
    use crate::mesh::samples::cube;
    use crate::mesh::vector::norm;
    use crate::metric::{Background, Source, Sym3};

    /// A cube of eight vertices, with sizes that grow from 0.02 at one of them.
    fn first_mesh() -> Sample {
        let (mut sample, fine) = (sample(Shape::Cube, 1, 1.0), cube(12));
        let logs = fine.vertices.iter().map(|&p| Sym3::IDENTITY.times((0.02 + 0.3 * norm(p)).powi(-2)).ln()).collect();
        sample.source = Source::Background(Background::new(fine.vertices.clone(), fine.tets.nodes.clone(), logs));
        sample
    }

    /// Insertions a vertex that is left.
    fn inserted(effort: Effort) -> f64 {
        let sample = first_mesh();
        let mut bench = Bench::new(&sample, 1, 3);
        let (inserted, left) = bench.with_pipeline(|pipeline| {
            pipeline.effort = effort;
            pipeline.run();
            (pipeline.work[Kind::Split as usize].counts.done as f64, pipeline.live() as f64)
        });
        bench.check("a first mesh");
        assert!(left > 200.0, "{left}");
        inserted / left
    }

    #[test]
    fn few_of_the_vertices_of_a_draft_are_inserted_in_vain() {
        let [draft, all] = [Effort::DRAFT, Effort::FULL].map(inserted);
        assert!(draft < 1.5 && draft < all, "{draft} {all}");
    }
}
