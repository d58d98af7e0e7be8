"""A solver of the case for geo-adapt cycle: fields and functionals of one of its problems.

    python solve.py advection|corner|sphere MESH SOLUTION     # files of meshio; result.json with the functionals goes beside the solution
"""

import importlib
import json
import sys
from pathlib import Path

import fem


def main():
    problem, source, target = importlib.import_module(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    mesh = fem.read(source)
    fields, functionals = problem.solve(mesh)
    fem.write(target, mesh, fields)
    target.with_name("result.json").write_text(json.dumps(functionals))
    print(f"{mesh.p.shape[1]} vertices: {functionals}")


if __name__ == "__main__":
    main()
