//! Why there is no metric of a goal.
use crate::metric::multiscale;

/// What is wrong with the terms of a goal. Vertices count from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// There is no term.
    #[error("no term is given: a goal has one pair of a weight and a field at least")]
    Nothing,
    /// A value of a field or an adjoint is NaN or infinite.
    #[error("the value of vertex {} is not a finite number: did the solver diverge?", vertex + 1)]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A weight is negative or no number.
    #[error("the weight of vertex {} is {value}: weights are numbers from 0 on, such as the absolute value of a derivative of the adjoint", vertex + 1)]
    Weight {
        /// The vertex.
        vertex: usize,
        /// What stands there.
        value: f64,
    },
    /// The values of a vertex are no state of a gas.
    #[error(
        "vertex {} has the density {density} and the pressure {pressure}: both must be positive; are these the variables that were said, in their \
         order?", vertex + 1
    )]
    State {
        /// The vertex.
        vertex: usize,
        /// ρ there.
        density: f64,
        /// p there.
        pressure: f64,
    },
    /// No term asks for any size.
    #[error(
        "no size follows from these terms: where weights are not zero, fields are constant or linear to rounding; is the adjoint the right one?"
    )]
    Flat,
    /// The metric cannot be made of Q.
    #[error(transparent)]
    Metric(#[from] multiscale::Error),
}
