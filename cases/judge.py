#!/usr/bin/env python3
"""Judges a tetrahedral mesh in a metric, independently of geo-adapt (METHOD.md §1; numpy alone).

    judge.py MESH --analytic polar-2
    judge.py MESH --metric MESH.solb --json
    judge.py MESH --analytic linear --geometry cube-cylinder --start IN.meshb

Exit code: 0 valid, 1 something is wrong with the mesh (it says what), 2 a file cannot be read.
"""

import argparse
import json
import sys

from judging import cube_cylinder, meshfile, metric, report


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh", help=".mesh or .meshb")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--analytic", choices=metric.FIELDS, help="the field to measure in")
    which.add_argument("--metric", help=".sol or .solb with one symmetric tensor a vertex")
    parser.add_argument("--complexity", type=float, help="scale the metric to this complexity on MESH first")
    parser.add_argument("--geometry", choices=["cube-cylinder"], help="compare the boundary with the exact geometry")
    parser.add_argument("--start", help="the mesh that MESH was made from: its references must still be there")
    parser.add_argument("--json", action="store_true", help="print JSON")
    return parser.parse_args()


def field(options, mesh):
    """The metric at the vertices of the mesh, or None."""
    if options.analytic:
        values = metric.analytic(options.analytic, mesh.points)
    elif options.metric:
        values = meshfile.read_metric(options.metric)
        if len(values) != len(mesh.points):
            raise meshfile.FileError(f"{options.metric}: {len(values)} values for {len(mesh.points)} vertices")
        metric.logarithm(values)
    else:
        return None
    if options.complexity:
        values = metric.scale_to(values, metric.complexity(mesh.points, mesh.tets, values), options.complexity)
    return values


def main():
    options = arguments()
    try:
        mesh = meshfile.read_mesh(options.mesh)
        values = field(options, mesh)
        result = report.counts(mesh) if values is None else report.figures(mesh, values)
        if options.geometry:
            start = meshfile.read_mesh(options.start) if options.start else None
            more, found = cube_cylinder.judge(mesh, start)
            result |= more
            result["findings"] = result["findings"] + found
    except (meshfile.FileError, OSError, ValueError) as error:
        print(f"judge: error: {error}", file=sys.stderr)
        return 2
    result["valid"] = not result["findings"]
    if options.json:
        print(json.dumps(result))
    else:
        report.show(result)
    return 0 if result["valid"] else 1


if __name__ == "__main__":
    sys.exit(main())
