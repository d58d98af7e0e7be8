# The first meshes come from `geo-adapt bootstrap`, which starts these. Sourced by cases/run.
# shellcheck shell=bash
setup_meshers
