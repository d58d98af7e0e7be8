"""A metric like that of the vortex over a delta wing: thin across a cone on the wing, coarser away from it."""

import numpy as np

# The cone: its axis from the wing's apex, in the plane of symmetry, and the tangent of its half angle. It cuts the upper side
# along y = 0.16 x.
AXIS = np.array([1.0, 0.0, 0.12])
TANGENT = 0.2
# The box about wing and cone.
NEAR = np.array([[0.0, 0.0, -0.0244], [1.0, 0.268, 0.33]])
# Size along the layer over what the place allows, size across it over that along, growth of sizes away from both.
ALONG, ACROSS, GROWTH_ACROSS, GROWTH_AWAY = 0.06, 0.08, 0.4, 0.3


def metric(points):
    """The field at `points`, shape (n, 3); returns (n, 3, 3).

    With s the distance along the axis and r that from it, φ = r cos α − s sin α is the signed distance from the cone. Sizes are proportional
    to the distance from the apex, up to 1, like the flow (0.1 is added, so that they are never nothing). An edge of the length h along the
    cone departs from it by h²/8R, R = s tan α: a quarter of the size across at most, so towards the apex the layer fades out.
    """
    axis = AXIS / np.linalg.norm(AXIS)
    cosine = 1 / np.hypot(1, TANGENT)
    s = points @ axis
    radial = points - s[:, None] * axis
    r = np.linalg.norm(radial, axis=1)
    phi = cosine * (r - s * TANGENT)
    normal = cosine * (radial / np.maximum(r, 1e-12)[:, None] - TANGENT * axis)
    away = np.linalg.norm(np.maximum(np.maximum(NEAR[0] - points, points - NEAR[1]), 0), axis=1)
    along = ALONG * (0.1 + np.clip(s, 0, 1)) + GROWTH_AWAY * away
    # On the axis there is no normal; there the sizes are all alike, since r is what bends the layers beside the cone.
    bends = along**2 / (2 * np.maximum(np.minimum(r, s * TANGENT), 1e-9))
    across = np.minimum(along, np.maximum(ACROSS * along, bends) + GROWTH_ACROSS * np.abs(phi))
    return (along**-2)[:, None, None] * np.eye(3) + (across**-2 - along**-2)[:, None, None] * np.einsum("ni,nj->nij", normal, normal)
