//! The `geo-adapt` program: hands over to [`geo_adapt::cli`].
use std::process::ExitCode;

#[global_allocator]
static MEMORY: geo_adapt::memory::HugePages = geo_adapt::memory::HugePages;

fn main() -> ExitCode {
    geo_adapt::cli::main()
}
