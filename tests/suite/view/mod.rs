//! `geo-adapt view`: pages and pictures.
mod browser;
mod page;
mod pictures;
