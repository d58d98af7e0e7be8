# The first mesh comes from gmsh, the flow from OpenFOAM or, with --solver su2, from SU2, which is there already. Sourced by cases/run.
# shellcheck shell=bash
setup_meshers
case " $* " in *" --solver su2 "* | *" --solver=su2 "*) ;; *) setup_packages openfoam ;; esac
