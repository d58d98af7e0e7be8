"""The law of the wall."""

import numpy as np

# Spalding's and the logarithmic law's constants.
KAPPA, B = 0.41, 5.0


def spalding(y_plus):
    """u⁺ of the law of Spalding (1961)."""
    u = np.linspace(0, 40, 40001)
    terms = KAPPA * u
    y = u + np.exp(-KAPPA * B) * (np.exp(terms) - 1 - terms - terms**2 / 2 - terms**3 / 6)
    return np.interp(y_plus, y, u)
