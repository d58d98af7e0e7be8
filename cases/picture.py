#!/usr/bin/env python3
"""Draws a tetrahedral mesh: its surface, and a cut by a plane, coloured by mean ratio (matplotlib, no display needed).

    picture.py MESH --analytic polar-1 -o MESH.png
    picture.py MESH --metric MESH.solb --cut x=0.3 --view 25,-60 -o MESH.png

Without a metric the shape is judged in the identity. Exit code 2: a file cannot be read.
"""

import argparse
import sys

import numpy as np

from judging import meshfile, metric


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh", help=".mesh or .meshb")
    parser.add_argument("-o", "--output", required=True, help="PNG (or PDF, SVG) to write")
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--analytic", choices=metric.FIELDS)
    which.add_argument("--metric", help=".sol or .solb")
    parser.add_argument("--cut", default=None, help="plane as x=0.3, y=… or z=…; default: z in the middle of the box")
    parser.add_argument("--view", default="28,215", help="elevation and azimuth of the eye in degrees (default %(default)s)")
    return parser.parse_args()


def ratios(options, mesh):
    """Mean ratio of each tet in the metric asked for."""
    if options.analytic:
        values = metric.analytic(options.analytic, mesh.points)
    elif options.metric:
        values = meshfile.read_metric(options.metric)
    else:
        values = np.broadcast_to(np.eye(3), (len(mesh.points), 3, 3))
    return metric.mean_ratios(mesh.points, mesh.tets, values)


def surface_colours(mesh, quality):
    """The least ratio of the tets behind each triangle."""
    worst = {}
    for face in ([1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]):
        for key, value in zip(map(tuple, np.sort(mesh.tets[:, face], axis=1).tolist()), quality):
            worst[key] = min(worst.get(key, 2.0), value)
    return np.array([worst.get(tuple(key), 0.0) for key in np.sort(mesh.triangles, axis=1).tolist()])


def cut_plane(text, points):
    """(axis, value) of a plane given as x=0.3, or the middle of the box in z."""
    if text is None:
        return 2, (points[:, 2].min() + points[:, 2].max()) / 2
    name, _, value = text.partition("=")
    if name not in ("x", "y", "z") or not value:
        raise ValueError(f"--cut {text}: expected x=…, y=… or z=…")
    return "xyz".index(name), float(value)


def sections(mesh, axis, value):
    """The polygons in which the plane cuts tets: [(index of the tet, points in the plane, shape (3 or 4, 2))]."""
    height = mesh.points[:, axis] - value
    height[height == 0] = 1e-14  # a plane through vertices: taken a hair below them
    above = height[mesh.tets] > 0
    axes = [i for i in range(3) if i != axis]
    found = []
    for tet in np.flatnonzero(above.any(axis=1) & ~above.all(axis=1)):
        nodes = mesh.tets[tet]
        up, down = nodes[above[tet]], nodes[~above[tet]]
        corners = []
        for a in up:
            for b in down:
                s = height[a] / (height[a] - height[b])
                corners.append((mesh.points[a] + s * (mesh.points[b] - mesh.points[a]))[axes])
        if len(corners) == 4:  # two above, two below: (a1 b1) (a1 b2) (a2 b2) (a2 b1) goes round
            corners[2], corners[3] = corners[3], corners[2]
        found.append((tet, np.array(corners)))
    return found


def draw(mesh, quality, options):
    """The two pictures side by side."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import PolyCollection
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    axis, value = cut_plane(options.cut, mesh.points)
    colours = pyplot.get_cmap("RdYlBu")
    width = 0.6 if len(mesh.tets) < 5_000 else 0.25
    figure = pyplot.figure(figsize=(15, 7.2))
    left = figure.add_subplot(1, 2, 1, projection="3d")
    shade = colours(np.clip(surface_colours(mesh, quality), 0, 1))
    left.add_collection3d(Poly3DCollection(mesh.points[mesh.triangles], facecolors=shade, edgecolors="black", linewidths=width))
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    left.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]), xlabel="x", ylabel="y", zlabel="z")
    left.set_box_aspect(high - low)
    left.view_init(*(float(word) for word in options.view.split(",")))
    left.set_title(f"{len(mesh.points)} vertices, {len(mesh.triangles)} triangles")
    right = figure.add_subplot(1, 2, 2)
    polygons = sections(mesh, axis, value)
    right.add_collection(PolyCollection([p for _, p in polygons], facecolors=colours(np.clip(quality[[t for t, _ in polygons]], 0, 1)),
                                        edgecolors="black", linewidths=width))
    names = [name for i, name in enumerate("xyz") if i != axis]
    right.set(xlabel=names[0], ylabel=names[1], aspect="equal", title=f"{len(polygons)} tetrahedra cut by {'xyz'[axis]} = {value:g}")
    right.autoscale_view()
    scale = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(0, 1), colours)
    figure.colorbar(scale, ax=right, label="mean ratio (surface: of the tetrahedron behind)", shrink=0.8)
    figure.savefig(options.output, dpi=150, bbox_inches="tight")


def main():
    options = arguments()
    try:
        mesh = meshfile.read_mesh(options.mesh)
        draw(mesh, ratios(options, mesh), options)
    except (meshfile.FileError, OSError, ValueError) as error:
        print(f"picture: error: {error}", file=sys.stderr)
        return 2
    print(f"wrote {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
