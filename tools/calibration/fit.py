"""Least squares over runs of the program, and how far the constants can be trusted."""

import dataclasses

import numpy as np
from scipy import optimize, stats

from . import residuals
from .element import Failed
from .tables import BadInput

STEP = 0.01  # of a difference, in units of a constant's start
LARGE_DEVIATION = 0.5  # relative: beyond it a constant is not identified
LARGE_CONDITION = 30.0  # of the Jacobian with columns of length one
AT_BOUND = 1e-3  # of the distance between the bounds
NO_EFFECT = 1e-5  # of the largest column of the Jacobian, in units of the starts


@dataclasses.dataclass
class Fit:
    """Answer: arrays in the order of the names; nan where a deviation cannot be told."""

    names: list
    values: np.ndarray
    deviations: np.ndarray
    low: np.ndarray
    high: np.ndarray
    correlation: np.ndarray
    condition: float
    at_bound: list
    residual_variance: float
    degrees_of_freedom: int
    cost: float
    evaluations: int
    message: str


class Problem:
    """Residuals and Jacobian in constants over their scales."""

    def __init__(self, program, constants, tests, deviations):
        self.program, self.constants, self.tests = program, constants, tests
        self.deviations = deviations
        low, high = np.array(constants.bounds).T
        start = np.array(constants.start)
        self.scale = np.where(np.abs(start) > 0.02 * (high - low), np.abs(start),
                              0.1 * (high - low))
        self.low, self.high, self.start = low / self.scale, high / self.scale, start / self.scale

    def at(self, points):
        """Residuals and whether all tests were answered, of each point."""
        sands = [self.constants.options(point * self.scale) for point in points]
        rows = self.program.responses(sands, self.tests)
        return [(residuals.of_all(self.tests, row, self.deviations),
                 not any(isinstance(response, Failed) for response in row)) for row in rows]

    def residual(self, point):
        return self.at([point])[0][0]

    def jacobian(self, point):
        """One-sided differences, all runs at once; to the other side where one fails."""
        step = np.where(point + STEP > self.high, -STEP, STEP)
        columns = self._columns(point, step)
        if any(column is None for column in columns):
            others = self._columns(point, -step)
            columns = [column if column is not None else other
                       for column, other in zip(columns, others)]
        if any(column is None for column in columns):
            raise BadInput("the program has no answer around the values "
                           f"{dict(zip(self.constants.names, point * self.scale))}; set out from "
                           "others (--set) or narrow the bounds (--bounds)")
        return np.array(columns).T

    def _columns(self, point, step):
        moved = np.clip(point + np.diag(step), self.low, self.high)
        (base, _), *rest = self.at([point, *moved])
        change = moved.diagonal() - point
        return [(row - base) / by if answered and by else None
                for (row, answered), by in zip(rest, change)]


def check_start(problem):
    sand = problem.constants.options(problem.start * problem.scale)
    for response in problem.program.responses([sand], problem.tests)[0]:
        if isinstance(response, Failed):
            raise BadInput(f"{response} (at the start of the fit)")


def least_squares(program, constants, tests, deviations, most_steps):
    problem = Problem(program, constants, tests, deviations)
    number = residuals.effective_number(tests, deviations)
    if number <= len(constants.names):
        raise BadInput(f"{number} readings cannot give {len(constants.names)} constants; give "
                       "more tests, or fit fewer constants (--fit)")
    check_start(problem)
    found = optimize.least_squares(problem.residual, problem.start, jac=problem.jacobian,
                                   bounds=(problem.low, problem.high), method="trf", ftol=1e-5,
                                   xtol=1e-4, max_nfev=most_steps)
    return confidence(problem, found, number)


def confidence(problem, found, number):
    """95 % intervals from the Jacobian; a constant at its bound is taken as given."""
    low, high = (limit * problem.scale for limit in (problem.low, problem.high))
    lengths = np.linalg.norm(found.jac, axis=0)
    matters = lengths > NO_EFFECT * lengths.max()
    values = np.where(matters, found.x, problem.start) * problem.scale
    margin = AT_BOUND * (high - low)
    at_bound = matters & ((values - low < margin) | (high - values < margin))
    used = matters & ~at_bound
    freedom = number - int(used.sum())
    variance = 2.0 * found.cost / freedom
    covariance, condition = invert(found.jac / problem.scale, used, variance)
    deviations = np.sqrt(covariance.diagonal())
    reach = stats.t.ppf(0.975, freedom) * deviations
    correlation = covariance / np.outer(deviations, deviations)
    return Fit(problem.constants.names, values, deviations, values - reach, values + reach,
               correlation, condition, at_bound.tolist(), variance, freedom, float(found.cost),
               int(found.nfev), found.message)


def invert(jacobian, used, variance):
    """Covariance, nan for what is not used, and the condition number."""
    covariance = np.full((len(used), len(used)), np.nan)
    if not used.any():
        return covariance, float("nan")
    lengths = np.linalg.norm(jacobian[:, used], axis=0)
    unit = jacobian[:, used] / lengths
    values = np.linalg.svd(unit, compute_uv=False)
    inverse = np.linalg.pinv(unit.T @ unit) / np.outer(lengths, lengths)
    covariance[np.ix_(used, used)] = variance * inverse
    return covariance, float(values[0] / values[-1]) if values[-1] > 0.0 else float("inf")


def warnings(fit):
    """What a user must know before using the constants."""
    texts = []
    for k, name in enumerate(fit.names):
        if fit.at_bound[k]:
            texts.append(f"{name} = {fit.values[k]:.4g} is at its bound: the tests ask for more "
                         "than is allowed, and the intervals take it as given")
        elif not np.isfinite(fit.deviations[k]):
            texts.append(f"{name} has no effect on these tests and was not changed")
        elif fit.deviations[k] > LARGE_DEVIATION * abs(fit.values[k]):
            texts.append(f"{name} is not identified: standard deviation {fit.deviations[k]:.2g} "
                         f"at {fit.values[k]:.4g}")
    if fit.condition > LARGE_CONDITION:
        texts.append(f"condition number {fit.condition:.0f}: constants make up for each other, "
                     f"most of all {strongest(fit)}; fix one of them")
    return texts


def strongest(fit):
    size = np.nan_to_num(np.abs(fit.correlation - np.diag(np.diag(fit.correlation))))
    first, second = np.unravel_index(np.argmax(size), size.shape)
    return f"{fit.names[first]} and {fit.names[second]} ({fit.correlation[first, second]:+.2f})"
