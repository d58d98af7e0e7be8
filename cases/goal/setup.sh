# The solver's own packages. Sourced by cases/run.
# shellcheck shell=bash
setup_python fem "$root/cases/advection-diffusion/requirements.txt"
