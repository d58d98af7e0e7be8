//! The library's enumerations as words on the command line: their names are the library's, the help is ours.
use crate::adapt::{Criterion, PointCreation, Scheduler};
use crate::metric::goal::{Boundary, Variables};
use crate::metric::recovery::Recovery;
use crate::metric::{Analytic, Scalar};
use crate::tasks::{Backend, Strategy};
use clap::ValueEnum;
use clap::builder::PossibleValue;

/// Gives each type, with its `ALL` and `name()`, a line of help for each variant.
macro_rules! value_enums {
    ($($kind:ty { $($variant:ident: $help:literal),+ $(,)? })+) => { $(
        impl ValueEnum for $kind {
            fn value_variants<'a>() -> &'a [Self] {
                &Self::ALL
            }

            fn to_possible_value(&self) -> Option<PossibleValue> {
                let help = match self {
                    $(Self::$variant => $help,)+
                };
                Some(PossibleValue::new(self.name()).help(help))
            }
        }
    )+ };
}

value_enums! {
    Boundary {
        Inside: "Second derivatives of the neighbours inside; weights no greater than theirs",
        Own: "As recovered there",
    }
    Variables {
        Conservative: "Density, momentum (3), total energy, each for a unit of volume",
        Primitive: "Density, velocity (3), pressure",
    }
    Criterion {
        Delaunay: "No vertex of the cavity inside the circumsphere, measured in five metrics (anisotropic Delaunay)",
        EdgeWeight: "Least greatest Laplacian edge weight (max-min)",
        MeanRatio: "Least Σ (1/Q − 1) of the mean ratios Q: the worst tetrahedra count most, and the others count",
    }
    PointCreation {
        Edge: "At the metric middle of long edges",
        Centroid: "At centroids of tetrahedra and surface triangles with long edges; at middles of edges where these fail",
        Eigenvector: "Inside at unit distance from vertices along the eigenvectors of their metrics; at middles of edges on the model, \
            where they are much too long, and where these fail",
    }
    Scheduler {
        Deterministic: "All threads, each in parts of the mesh that do not depend on them: the same mesh bit for bit for any number of \
            threads",
        Speculative: "All threads, each where no other is at the moment: another mesh, as good, each time",
        Sequential: "One thread, one item after the other",
    }
    Backend {
        Stealing: "Our own work-stealing threads: each takes its newest task, or another's oldest; the caller is one of them",
        Rayon: "The threads of rayon",
        Tbb: "oneTBB; needs the feature `tbb`",
        OpenMp: "OpenMP's tasks; needs the feature `openmp`. Its idle threads wait busily, unless OMP_WAIT_POLICY=passive is in the \
            environment: without it a loop took 12 ms on a machine whose cores had other work too, with it 5 µs",
    }
    Strategy {
        Flat: "One task makes all the others",
        TwoLevel: "Two tasks a thread, each of which makes its share",
        Hierarchical: "Each task gives half of what it has away until one chunk is left",
    }
    Analytic {
        Linear: "A layer of thickness 0.001 at z = 0.5",
        Polar1: "A layer on the cylinder r = 0.5, tangential sizes 0.1",
        Polar2: "The same with the circumferential size down to 1/40 at the cylinder",
    }
    Scalar {
        Sinfun3: "Waves of two amplitudes; continuous, with kinks where the amplitude changes",
        Tanh3: "Two fronts beside y = 0.3, and at z = 0 a layer that is 1e-6 thin at its thinnest",
        Sinatan3: "Small waves, and a jump of π where sin 5y = 2xz",
    }
    Recovery {
        Fit: "A quadratic function for each vertex, fitted to the values of its neighbours and theirs: exact for quadratics, on the \
            boundary too",
        L2: "The gradients of the elements, averaged to the vertices, twice: smooths more",
        Jumps: "As fit, but made for fields with jumps or shocks: where the values jump the second derivative across counts more, so \
            that fewer and thinner layers come",
    }
}
