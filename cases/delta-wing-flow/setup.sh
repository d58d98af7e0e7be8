# The first mesh comes from gmsh, the flow from OpenFOAM. Sourced by cases/run.
# shellcheck shell=bash
setup_meshers
setup_packages openfoam
