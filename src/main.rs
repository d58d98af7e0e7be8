//! The `geo-adapt` program: hands over to [`geo_adapt::cli`].
use std::process::ExitCode;

fn main() -> ExitCode {
    geo_adapt::cli::main()
}
