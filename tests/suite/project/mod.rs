//! What holds for the source itself.
mod dependencies;
mod imports;
mod layers;
