//! `geo-adapt image-mesh`.
mod files;
mod mesh;
