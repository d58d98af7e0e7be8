//! What is read and written: formats, damage, names, disks that are full.
mod any_format;
mod convert;
mod damaged;
mod foam;
mod full_disk;
mod libmeshb;
mod meshes;
mod odd_names;
mod own;
