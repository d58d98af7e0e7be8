//! New vertices: on long edges, at centroids, at unit distance along eigenvectors, and where the surface deviates from the model.
pub mod centroid;
pub mod deviating;
pub mod edge_split;
pub mod metric_orthogonal;
pub mod vertex;
