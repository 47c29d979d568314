"""What of a curve repeats itself with the cells, as a share of the curve."""

import numpy as np

GAIN = 1.19  # of a wave by what is left of it beside such a parabola: 1 + 15/8 times 1/pi^2


def wave(x, y, period):
    """Amplitude of the Fourier component of y/smooth(y) - 1 over whole periods of x. What is smooth
    is a parabola fitted within one period to each side."""
    grid = np.arange(x[0] + period, x[-1] - period, period / 24.0)
    ratio = np.empty_like(grid)
    for k, at in enumerate(grid):
        near = np.abs(x - at) <= period
        smooth = np.polynomial.Polynomial.fit(x[near], y[near], 2)
        ratio[k] = np.interp(at, x, y) / smooth(at) - 1.0
    whole = 24 * (len(grid) // 24)
    phase = np.exp(2j * np.pi * grid[:whole] / period)
    return 2.0 / GAIN * abs(np.mean(ratio[:whole] * phase))


def amplitude(x, y, cell):
    """The wave with the period of the cell and, as what a curve has of any period, the mean of
    those with 0.8 and 1.25 times that period."""
    return wave(x, y, cell), 0.5 * (wave(x, y, 0.8 * cell) + wave(x, y, 1.25 * cell))
