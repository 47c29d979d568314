"""Particle values as a continuous picture."""

import numpy as np
from matplotlib.tri import Triangulation

# A triangle whose longest side exceeds this many particle distances bridges a hole or a free
# surface; shear bands stretch neighbours to two or three.
LONGEST_SIDE = 4.5


def side_lengths(points, triangles):
    corners = points[triangles]
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)


def nearest_distances(points, triangles, lengths):
    """Of each point to its nearest neighbour in the triangulation."""
    nearest = np.full(len(points), np.inf)
    for side in range(3):
        np.minimum.at(nearest, triangles[:, side], lengths[:, side])
        np.minimum.at(nearest, triangles[:, side - 1], lengths[:, side])
    return nearest


def triangulate(points, hole=None, longest_side=LONGEST_SIDE):
    """Delaunay triangulation without the triangles that cross empty space. `hole` is a function of
    triangle centres, true where there is no material. None when the points span no area."""
    try:
        mesh = Triangulation(points[:, 0], points[:, 1])
    except (RuntimeError, ValueError):
        return None
    lengths = side_lengths(points, mesh.triangles)
    spacing = nearest_distances(points, mesh.triangles, lengths)
    # Smoothed, since two particles may happen to be very close.
    spacing = np.maximum(spacing, 0.5 * np.median(spacing))
    empty = lengths.max(axis=1) > longest_side * spacing[mesh.triangles].max(axis=1)
    if hole is not None:
        empty |= hole(points[mesh.triangles].mean(axis=1))
    mesh.set_mask(empty)
    return mesh
