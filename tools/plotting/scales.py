"""Ranges of colours; a few particles must not set them."""

import numpy as np

BULK = (0.002, 0.998)


def rounded_up(value):
    """The next of 1, 1.5, 2, 2.5, 3, 4, 5, 6, 8 times a power of ten."""
    if not value > 0:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps = np.array([1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10])
    return float(power * steps[np.searchsorted(steps, value / power * (1 - 1e-9))])


def from_zero(values):
    return 0.0, rounded_up(np.quantile(values, BULK[1]))


def about_far_field(values):
    """As far to both sides of the median, which is the undisturbed soil's value."""
    middle = np.median(values)
    reach = max(np.abs(np.quantile(values, BULK) - middle).max(), 1e-3)
    return middle - reach, middle + reach
