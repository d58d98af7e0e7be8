//! The program's memory: large arrays on huge pages ([`HugePages`]), how much of it there is ([`available`]), and what happens
//! where there is no more ([`end`]).
mod available;
pub mod end;
mod pages;

pub use available::available;
pub use end::try_zeroed_vec;
pub use pages::HugePages;
