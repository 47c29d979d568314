"""Shear bands of a biaxial specimen: their inclination and thickness from the particles' strain."""

import numpy as np
from matplotlib.tri import LinearTriInterpolator

from plotting.biaxial import LONGEST_SIDE
from plotting.particle_field import triangulate

ANGLES = np.radians(np.arange(30.0, 75.5, 1.0))  # from the horizontal
SPACING = 0.01  # m, between the lines that are tried, and between places on a line
SHORTEST = 0.7  # m, of a line through the specimen


class Field:
    """Deviatoric strain between the particles of one output."""

    def __init__(self, output):
        position = output.field("position")[:, :2]
        mesh = triangulate(position, longest_side=LONGEST_SIDE)
        self.value = LinearTriInterpolator(mesh, output.field("deviatoric_strain"))
        self.low, self.high = position.min(axis=0), position.max(axis=0)

    def profile(self, angle, family):
        """Offsets of parallel lines from the specimen's middle, and the mean strain along each;
        masked where a line is too short. The family, 1 or -1, says to which side they rise."""
        along = np.array([np.cos(angle), family * np.sin(angle)])
        across = np.array([-along[1], along[0]])
        reach = 0.5 * np.hypot(*(self.high - self.low))
        places = np.arange(-reach, reach, SPACING)
        points = (0.5 * (self.low + self.high) + places[:, None, None] * across
                  + places[None, :, None] * along)
        values = self.value(points[..., 0], points[..., 1])
        short = values.count(axis=1) * SPACING < SHORTEST
        return places, np.ma.masked_array(values.mean(axis=1), short)


def width_at_half(places, profile):
    """Full width at half of what the largest value has more than the median."""
    profile = profile.filled(0.0)
    peak = int(np.argmax(profile))
    half = 0.5 * (profile[peak] + np.median(profile[profile > 0.0]))
    first, last = peak, peak
    while first > 0 and profile[first - 1] > half:
        first -= 1
    while last + 1 < len(profile) and profile[last + 1] > half:
        last += 1
    return places[last] - places[first] + SPACING


def measure(output):
    """Inclination in degrees and thickness in m, means of the two families: those of the straight
    line through the specimen along which the mean strain is largest."""
    field = Field(output)
    found = []
    for family in (1, -1):
        profiles = [field.profile(angle, family) for angle in ANGLES]
        best = int(np.argmax([profile.max() for _, profile in profiles]))
        found.append((np.degrees(ANGLES[best]), width_at_half(*profiles[best])))
    return np.mean(found, axis=0)
