"""The zoo's anisotropic field: a planar layer through the middle of the model's box, which lies askew to all its axes."""

import numpy as np

NORMAL = np.array([0.36, 0.48, 0.8])
# Over the diagonal of the box: the size across in the layer, the size along it; and the growth of that across per distance.
ACROSS, ALONG, GROWTH = 1e-3, 0.1, 0.2


def metric(points, middle, diagonal):
    """The field at `points`, shape (n, 3); returns (n, 3, 3). Sizes are ALONG everywhere but across the layer."""
    distance = np.abs((points - middle) @ NORMAL)
    across = np.minimum(ALONG * diagonal, ACROSS * diagonal + GROWTH * distance)
    along = (ALONG * diagonal) ** -2
    return along * np.eye(3) + (across**-2 - along)[:, None, None] * np.outer(NORMAL, NORMAL)
