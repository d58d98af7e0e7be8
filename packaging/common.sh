# What all packages begin with: the program as it is shipped, its manual pages and completions. Sourced, not run.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=../scripts/setup.sh
source "$root/scripts/setup.sh"
cd "$root"
packages=$root/target/packages
version=$(sed -n 's/^version *= *"\(.*\)"/\1/p' Cargo.toml | head -n 1)

# Builds the program, and makes the files that are made from its help.
build() {
    setup_build
    say "the program (profile dist)"
    cargo build --profile dist --locked
    local program=target/dist/geo-adapt
    mkdir -p "$packages/man" "$packages/completions"
    "$program" man "$packages/man"
    "$program" completions bash >"$packages/completions/geo-adapt.bash"
    "$program" completions zsh >"$packages/completions/_geo-adapt"
    "$program" completions fish >"$packages/completions/geo-adapt.fish"
    gzip --best --no-name --force "$packages"/man/*.1
}
