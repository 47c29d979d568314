"""The rigid bodies of a scene put together by options: where they are and what they look like."""

from dataclasses import dataclass

import numpy as np

from .run import MissingData

KINDS = ["box", "ball", "polygon", "layer", "plane"]
AXES = "xyz"


@dataclass
class Body:
    """A shape as its option gives it, and the place where the run has put it."""

    name: str
    kind: str
    numbers: np.ndarray
    dimension: int
    position: np.ndarray
    angle: float
    far: float  # m, more than one sees

    def outline(self, z=None):
        """Corners in the plane, at the height z of it in space; None where it does not get there.
        On a line, its two ends."""
        offset = 0.0 if self.dimension < 3 else z - self.position[2]
        corners = SHAPES[self.kind](self, offset)
        if corners is None or self.dimension == 1:
            return corners if corners is None else self.position + corners
        return self.position[:2] + corners @ rotation(self.angle).T


def rotation(angle):
    """Turns anticlockwise."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def rectangle(width, height):
    return 0.5 * np.array([[-width, -height], [width, -height], [width, height], [-width, height]])


def box(body, offset):
    lower, upper = np.split(body.numbers, 2)
    sides = upper - lower
    if body.dimension == 1:
        return 0.5 * np.array([-sides[0], sides[0]])
    if body.dimension == 3 and abs(offset) > 0.5 * sides[2]:
        return None
    return rectangle(sides[0], sides[1])


def ball(body, offset):
    radius = body.numbers[-1]
    if body.dimension == 1:
        return np.array([-radius, radius])
    if abs(offset) >= radius:
        return None
    turn = np.linspace(0, 2 * np.pi, 181)[:-1]
    return np.sqrt(radius**2 - offset**2) * np.column_stack([np.cos(turn), np.sin(turn)])


def polygon(body, _):
    corners = body.numbers.reshape(-1, 2)
    return corners - centroid(corners)


def centroid(corners):
    """Of the area."""
    following = np.roll(corners, -1, axis=0)
    weight = corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]
    return weight @ (corners + following) / (3 * weight.sum())


def layer(body, _):
    height = body.numbers[1] - body.numbers[0]
    if body.dimension == 1:
        return 0.5 * np.array([-height, height])
    return rectangle(2 * body.far, height)


def plane(body, offset):
    """All behind it, as far as one sees."""
    normal = body.numbers[body.dimension:]
    if body.dimension == 1:
        return np.array([0.0, -np.sign(normal[0]) * body.far])
    flat = normal[:2]
    square = flat @ flat
    across = normal[2] * offset if body.dimension == 3 else 0.0
    if square == 0.0:
        return rectangle(2 * body.far, 2 * body.far) if across < 0 else None
    out = flat / np.sqrt(square)
    along = np.array([-out[1], out[0]])
    sides = body.far * np.array([along, -along, -along - out, along - out])
    return sides - across * flat / square


SHAPES = {"box": box, "ball": ball, "polygon": polygon, "layer": layer, "plane": plane}


def dimension_of(run):
    return int(run.option("dimension"))


def domain_of(run):
    """Lower and upper corner."""
    return np.split(run.numbers("domain"), 2)


def body_at(run, name, places):
    """`places` has numbers named like NAME_x_m: attributes of an output, or of a row."""
    kinds = [kind for kind in KINDS if run.words(f"body_{name}_{kind}")]
    dimension = dimension_of(run)
    columns = [f"{name}_{axis}_m" for axis in AXES[:dimension]]
    if not kinds or any(column not in places for column in columns):
        raise MissingData(f"'{run.directory}' does not say what and where the body '{name}' is")
    lower, upper = domain_of(run)
    return Body(name, kinds[0], run.numbers(f"body_{name}_{kinds[0]}"), dimension,
                np.array([float(places[column]) for column in columns]),
                float(places.get(f"{name}_angle_rad", 0.0)), 4 * np.linalg.norm(upper - lower))


def bodies_at(run, places):
    return [body_at(run, name, places) for name in run.words("bodies")]


def cuts(run, position):
    """Directions in which the body lies on a wall of symmetry, which leaves half of it."""
    walls, domain = run.words("walls"), domain_of(run)
    reach = 1e-9 * np.linalg.norm(domain[1] - domain[0])
    return [d for d in range(dimension_of(run)) for side in (0, 1)
            if walls[2 * d + side] == "symmetry" and abs(position[d] - domain[side][d]) < reach]
