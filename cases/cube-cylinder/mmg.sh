#!/usr/bin/env bash
# Optional: mmg3d -hgrad -1 on the same start mesh, fields and cycles, for case.py to compare CPU time with.
# Usage: cases/cube-cylinder/mmg.sh [START.meshb] (default: the UGAWG mesh if it is there, else the own one)
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
# shellcheck source=../../scripts/setup.sh
source "$root/scripts/setup.sh"
setup_python mmg "$root/cases/requirements-mmg.txt"
shared=${GEO_ADAPT_SHARED:-$root/../shared}/cases/cube-cylinder/cube-cylinder.meshb
start=${1:-$([ -f "$shared" ] && echo "$shared" || echo "$root/cases/cube-cylinder/start.meshb")}
say "mmg3d from $start"
"$root/.venv/mmg/bin/python" "$root/cases/cube-cylinder/mmg.py" "$start"
