"""What can be fitted, between which bounds, and the options of the program that follow."""

import math

from .tables import BadInput

# Bounds of each constant: where the law still means something.
BOUNDS = {
    "G0": (10.0, 2000.0), "kappa": (1e-4, 0.2), "bulk_xi": (0.01, 1.0), "poisson": (-0.9, 0.49),
    "Mc": (0.6, 2.0), "c": (0.42, 0.99), "e_Gamma": (0.3, 2.0), "lambda_c": (0.0, 0.3),
    "xi": (0.05, 1.0), "d0": (0.01, 1.5), "m": (0.0, 20.0), "eps_r": (0.003, 0.5),
}
C_RULES = ("formula", "peak", "sand")


class Constants:
    """Names that are fitted, their start and bounds, and how a point becomes options."""

    def __init__(self, sand, names, settings, bounds, peak_angle):
        self.sand, self.names, self.settings = sand, names, dict(settings)
        self.bounds = [bounds.get(name, BOUNDS[name]) for name in names]
        self.peak_angle = peak_angle
        self.settings.setdefault("c", "peak")
        self.start = []

    def take_start(self, defaults):
        """Values from which the fit sets out: what was set, else the sand's own."""
        self.start = [self._start_of(name, defaults) for name in self.names]
        self.defaults = defaults

    def _start_of(self, name, defaults):
        value = self.settings.get(name, defaults.get(f"sand_{name}"))
        if name == "c" and value in C_RULES:
            value = defaults["sand_c"]
        try:
            value = float(value)
        except (TypeError, ValueError):
            raise BadInput(f"--fit {name}: this sand has no {name} to start from; give one by "
                           f"--set {name}=VALUE") from None
        low, high = self.bounds[self.names.index(name)]
        if not low <= value <= high:
            raise BadInput(f"--fit {name}: the start {value:g} is outside {low:g} to {high:g}; "
                           f"allowed: another --set {name}=VALUE or --bounds {name}=LOW:HIGH")
        return value

    def base_options(self):
        """Options of the program without what is fitted."""
        options = {"sand": self.sand} if self.sand else {}
        for name, value in self.settings.items():
            if name != "c" or value not in C_RULES:
                options[f"sand_{name}"] = value
        return options

    def options(self, point):
        """Options of the program for the values of the fitted constants."""
        options = self.base_options()
        options |= {f"sand_{name}": repr(float(value)) for name, value in zip(self.names, point)}
        ratio = self._extension_ratio(options)
        return options if ratio is None else options | {"sand_c": repr(ratio)}

    def _extension_ratio(self, options):
        """c where it follows from an angle that compression and extension share."""
        rule = self.settings["c"]
        if "c" in self.names or rule not in ("formula", "peak"):
            return None
        if rule == "peak":
            return equal_angles(math.sin(math.radians(self.peak_angle)))
        Mc = float(options.get("sand_Mc", self.defaults["sand_Mc"]))
        return equal_angles(3.0 * Mc / (6.0 + Mc))


def equal_angles(sine):
    return (3.0 - sine) / (3.0 + sine)


def parse_names(text):
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name not in BOUNDS:
            raise BadInput(f"--fit {text}: '{name}' cannot be fitted; allowed: "
                           f"{', '.join(BOUNDS)}, separated by commas")
    if len(set(names)) < len(names):
        raise BadInput(f"--fit {text}: a constant is named twice")
    return names


def parse_settings(pairs):
    settings = {}
    for pair in pairs:
        name, equals, value = pair.partition("=")
        if not equals or not name or not value:
            raise BadInput(f"--set {pair}: allowed is NAME=VALUE, NAME an option -sand_NAME of "
                           "the program")
        settings[name.removeprefix("-").removeprefix("sand_")] = value
    return settings


def parse_bounds(pairs):
    bounds = {}
    for pair in pairs:
        name, _, limits = pair.partition("=")
        try:
            low, high = (float(limit) for limit in limits.split(":"))
        except ValueError:
            low, high = 1.0, 0.0
        if name not in BOUNDS or not low < high:
            raise BadInput(f"--bounds {pair}: allowed is NAME=LOW:HIGH with LOW < HIGH and NAME "
                           f"one of {', '.join(BOUNDS)}")
        bounds[name] = (low, high)
    return bounds
