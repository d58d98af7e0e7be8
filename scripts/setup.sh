# Set-up shared by cases/run and tests/run; sourced, not run. Every step looks first and costs nothing when it is done.
# Made for Debian 12; on another system it says what is missing and goes on with what is there.
# shellcheck shell=bash

setup_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
OCCT_PACKAGES=(libocct-foundation-dev libocct-modeling-data-dev libocct-modeling-algorithms-dev
    libocct-data-exchange-dev libocct-ocaf-dev)

say() { printf '== %s\n' "$*"; }
fail() {
    printf 'error: %s\n' "$*" >&2
    exit 2
}

# apt-get with sudo where we are not root.
apt_get() {
    local as=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || fail "root rights are needed for: apt-get $* (run it as root, then start again)"
        as=(sudo)
    fi
    "${as[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y "$@"
}

# Installs those of the named Debian packages that are missing.
setup_packages() {
    local missing=() package
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        say "no Debian system: these must be there already, under their names here: $*"
        return
    fi
    for package in "$@"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    say "installing ${missing[*]}"
    apt_get update >/dev/null
    apt_get install --no-install-recommends "${missing[@]}" >/dev/null
}

# The least Rust release, from Cargo.toml.
wanted_rust() { sed -n 's/^rust-version *= *"\(.*\)"/\1/p' "$setup_root/Cargo.toml"; }

# Whether version $1 is at least $2.
at_least() { printf '%s\n%s\n' "$2" "$1" | sort -V -C; }

# cargo, recent enough: the one there, rustup's, or Debian's cargo-web (security updates carry a recent one).
setup_cargo() {
    local wanted have candidate
    wanted=$(wanted_rust)
    local remedy="Install a recent one from https://rustup.rs and start again"
    if ! command -v cargo >/dev/null && [ -x "${CARGO_HOME:-$HOME/.cargo}/bin/cargo" ]; then
        PATH=${CARGO_HOME:-$HOME/.cargo}/bin:$PATH
    fi
    if ! command -v cargo >/dev/null; then
        command -v apt-get >/dev/null || fail "cargo is not there. $remedy"
        apt_get update >/dev/null
        candidate=$(apt-cache policy cargo-web | sed -n 's/^ *Candidate: *//p')
        at_least "${candidate:-0}" "$wanted" || fail "cargo is not there, and Debian's cargo-web is ${candidate:-missing}, older than $wanted. $remedy"
        setup_packages cargo-web rustfmt-web
    fi
    have=$(cargo --version | sed 's/^cargo \([0-9.]*\).*/\1/')
    at_least "$have" "$wanted" || fail "cargo is $have (of $(command -v cargo)), $wanted or later is needed. $remedy"
}

# Everything that building the program needs.
setup_build() {
    setup_packages ca-certificates g++ "${OCCT_PACKAGES[@]}"
    setup_cargo
}

# A virtual environment .venv/NAME with the packages of a requirements file; made anew when the file changes.
setup_python() {
    local name=$1 requirements=$2
    local place=$setup_root/.venv/$name
    if cmp -s "$requirements" "$place/installed.txt"; then return; fi
    setup_packages python3 python3-venv
    say "virtual environment .venv/$name from ${requirements#"$setup_root"/}"
    rm -rf "$place"
    python3 -m venv "$place"
    "$place/bin/pip" install --quiet --disable-pip-version-check -r "$requirements"
    cp "$requirements" "$place/installed.txt"
}

# What `geo-adapt bootstrap` starts: gmsh, and netgen for what gmsh cannot do (Debian's netgen is older and aborts on more models).
setup_meshers() {
    setup_packages gmsh
    setup_python mesher "$setup_root/scripts/mesher-requirements.txt"
}
