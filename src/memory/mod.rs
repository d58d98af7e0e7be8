//! The program's memory: large arrays on huge pages ([`HugePages`]), and what happens where there is no more of it ([`end`]).
pub mod end;
mod pages;

pub use end::try_zeroed_vec;
pub use pages::HugePages;
