//! The kernel: the mesh store, its operations, and the passes that make a unit mesh.
