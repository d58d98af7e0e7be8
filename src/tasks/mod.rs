//! The tasking front-end. Knows no mesh.
mod pool;

pub use pool::Pool;
