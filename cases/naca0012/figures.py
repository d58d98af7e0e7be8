"""What a flow about the NACA 0012 shows: pressures, friction and profiles on the slab, and an ideal flow beside them."""

import airfoil
import numpy as np

# Of the flow in flow.cfg, in its units: density and pressure of the free stream are 1.
MACH, REYNOLDS, GAMMA = 0.15, 6e6, 1.4
SPEED = MACH * np.sqrt(GAMMA)
WALL = (1, 2)


def on_wall(mesh, fields):
    """{side: (x, c_p, c_f), by x}; c_f is that of the friction along +x."""
    found = {}
    for number in WALL:
        nodes = np.unique(mesh.triangles[mesh.triangle_refs == number])
        nodes = nodes[np.argsort(mesh.points[nodes, 0])]
        pressure = (fields["Pressure"][nodes] - 1) / (0.5 * SPEED**2)
        found[airfoil.NAMES[number]] = mesh.points[nodes, 0], pressure, fields["Skin_Friction_Coefficient"][nodes, 0]
    return found


def profile(mesh, fields, at, friction, width=0.01):
    """y⁺ and u⁺ above the upper side at the points within a strip about one x, by the friction there."""
    x, z = mesh.points[:, 0], mesh.points[:, 2]
    strip = np.flatnonzero((np.abs(x - at) < width) & (z > 0))
    step = 1e-6
    slope = (airfoil.half(x[strip] + step) - airfoil.half(x[strip] - step)) / (2 * step)
    along = 1 / np.sqrt(1 + slope**2)
    height = (z[strip] - airfoil.half(x[strip])) * along
    momentum = fields["Momentum"][strip]
    speed = (momentum[:, 0] + momentum[:, 2] * slope) * along / fields["Density"][strip]
    shear = SPEED * np.sqrt(0.5 * friction)
    y_plus = height * REYNOLDS * np.sqrt(0.5 * friction)
    order = np.argsort(y_plus)
    return y_plus[order], speed[order] / shear


def heights(mesh):
    """Of the tetrahedra upon the wall's triangles between x = 0.05 and 0.95: heights (n,), and the ratios of their longest edges to them."""
    wall = mesh.triangles[np.isin(mesh.triangle_refs, WALL)]
    keys, upon = {tuple(sorted(face)) for face in wall.tolist()}, []
    touching = mesh.tets[np.isin(mesh.tets, np.unique(wall)).sum(axis=1) >= 3]
    for nodes in touching.tolist():
        for skipped in range(4):
            face = nodes[:skipped] + nodes[skipped + 1:]
            if tuple(sorted(face)) in keys:
                upon.append([*face, nodes[skipped]])
    corners = mesh.points[np.array(upon)]
    corners = corners[np.abs(corners[:, :, 0].mean(axis=1) - 0.5) < 0.45]
    a, b, c = (corners[:, k] - corners[:, 0] for k in (1, 2, 3))
    normal = np.cross(a, b)
    height = np.abs(np.einsum("ij,ij->i", normal, c)) / np.linalg.norm(normal, axis=1)
    edges = [np.linalg.norm(corners[:, i] - corners[:, j], axis=1) for i in range(4) for j in range(i)]
    return height, np.max(edges, axis=0) / height


def ideal(angle, panels=240):
    """x, c_p around the profile, and C_L of the plane potential flow at an angle of attack in degrees.

    Hess and Smith's panels: sources of a strength each and vortices of one strength for all, no flow through the middles, and equal speeds at both panels of the trailing edge.
    """
    turn = np.linspace(0, 2 * np.pi, panels + 1)
    x = 0.5 * (1 + np.cos(turn))
    z = -np.sign(np.sin(turn)) * airfoil.half(x)
    z[[0, -1]] = 0.0
    begin, end = np.column_stack([x[:-1], z[:-1]]), np.column_stack([x[1:], z[1:]])
    along = end - begin
    length = np.linalg.norm(along, axis=1)
    tangent = along / length[:, None]
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    middle = 0.5 * (begin + end)
    # In the frame of each panel: the velocity of a source of strength one along and across it.
    offset = middle[:, None] - begin[None]
    s, h = np.einsum("ijk,jk->ij", offset, tangent), np.einsum("ijk,jk->ij", offset, normal)
    along_it = np.log((s**2 + h**2) / ((s - length) ** 2 + h**2)) / (4 * np.pi)
    across_it = (np.arctan2(h, s - length) - np.arctan2(h, s)) / (2 * np.pi)
    np.fill_diagonal(across_it, 0.5)
    source = along_it[..., None] * tangent[None] + across_it[..., None] * normal[None]
    # A vortex's velocity is that of a source, turned by a right angle.
    vortex = (across_it[..., None] * tangent[None] - along_it[..., None] * normal[None]).sum(axis=1)
    wind = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    matrix, right = np.zeros((panels + 1, panels + 1)), np.zeros(panels + 1)
    matrix[:-1, :-1], matrix[:-1, -1] = np.einsum("ijk,ik->ij", source, normal), np.einsum("ik,ik->i", vortex, normal)
    right[:-1] = -normal @ wind
    ends = [0, panels - 1]
    matrix[-1, :-1] = np.einsum("ijk,ik->j", source[ends], tangent[ends])
    matrix[-1, -1], right[-1] = np.einsum("ik,ik->", vortex[ends], tangent[ends]), -(tangent[ends] @ wind).sum()
    strength = np.linalg.solve(matrix, right)
    speed = tangent @ wind + np.einsum("ijk,ik,j->i", source, tangent, strength[:-1]) + np.einsum("ik,ik->i", vortex, tangent) * strength[-1]
    pressure = 1 - speed**2
    force = -(pressure * length) @ normal
    return middle[:, 0], pressure, float(force @ [-wind[1], wind[0]])
