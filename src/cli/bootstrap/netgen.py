"""Meshes a model with netgen and writes the mesh as MSH 4.1. Usage: netgen_driver.py MODEL.brep OUT.msh GREATEST SEGMENTS

GREATEST is the greatest size in model units, SEGMENTS the number of segments for a radian of curvature. Triangles have the number of
their face, tetrahedra that of their solid, in the order of OpenCASCADE's TopExp::MapShapes; which edge a node is on is not told.
"""

import sys

try:
    import netgen.occ
    import netgen.meshing
except ImportError as error:
    print(f"Error: this Python has no netgen ({error})")
    sys.exit(77)


def write(path, points, triangles, tets):
    """Writes points, and the elements by their entity, {entity: [nodes, ...]}, nodes from 1."""
    with open(path, "w") as file:
        file.write("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n")
        file.write(f"1 {len(points)} 1 {len(points)}\n3 0 0 {len(points)}\n")
        file.writelines(f"{i}\n" for i in range(1, len(points) + 1))
        file.writelines("%.17g %.17g %.17g\n" % p for p in points)
        total = sum(len(elements) for kind in (triangles, tets) for elements in kind.values())
        file.write(f"$EndNodes\n$Elements\n{len(triangles) + len(tets)} {total} 1 {total}\n")
        number = 0
        for dimension, code, kind in ((2, 2, triangles), (3, 4, tets)):
            for entity, elements in sorted(kind.items()):
                file.write(f"{dimension} {entity} {code} {len(elements)}\n")
                for nodes in elements:
                    number += 1
                    file.write(f"{number} {' '.join(map(str, nodes))}\n")
        file.write("$EndElements\n")


def main():
    model, out, greatest, segments = sys.argv[1], sys.argv[2], float(sys.argv[3]), float(sys.argv[4])
    geometry = netgen.occ.OCCGeometry(model)
    # Netgen's curvature safety is the number of segments for a radius of curvature.
    mesh = geometry.GenerateMesh(maxh=greatest, curvaturesafety=max(segments, 1.5), grading=0.3)
    points = [tuple(p.p) for p in mesh.Points()]
    triangles, tets = {}, {}
    for element in mesh.Elements2D():
        nodes = [v.nr for v in element.vertices]
        triangles.setdefault(element.index, []).append(nodes)
    for element in mesh.Elements3D():
        nodes = [v.nr for v in element.vertices]
        if len(nodes) != 4:
            sys.exit("Error: netgen made something else than tetrahedra")
        tets.setdefault(element.index, []).append(nodes)
    write(out, points, triangles, tets)


main()
