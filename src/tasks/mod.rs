//! The tasking front-end. Knows no mesh.
