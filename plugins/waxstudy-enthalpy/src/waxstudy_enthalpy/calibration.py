"""Fit the motor's free parameters to the characteristic times of the paper's empirical model, and say what they fix.

Times alone leave two scales open. All heat may be scaled (power, capacities, mass, conductances); the holding power of
a data sheet fixes it. All temperatures above ambient may be scaled against capacities per kelvin; the melting range of
a maker's test fixes it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy_enthalpy.bench import Rig, empirical, parameters, steady_times
from waxstudy_enthalpy.parameters import EnthalpyParameters
from waxstudy_enthalpy.products import PRODUCTS

# free parameter -> physical bounds (temperatures: see `bounds`); all others keep their defaults
FREE: Mapping[str, tuple[float, float]] = {
    "knee_C": (21.0, 84.0),
    "holding_C": (77.0, 130.0),
    "cup_J_K": (0.3, 30.0),
    "body_J_K": (3.0, 60.0),
    "wax_g": (0.15, 3.0),
    "core_body_W_K": (0.03, 0.6),
    "expansion_mm": (3.2, 6.0),
}
SEEDS = (1, 2, 3)
PENALTY_S = 300.0  # for parameters that make no motor
DEFAULTS: Mapping[str, float] = {
    name: field.default for name, field in EnthalpyParameters.model_fields.items() if isinstance(field.default, float)
}


def bounds(fixed: Mapping[str, float]) -> tuple[FloatArray, FloatArray]:
    """Return the bounds of the free parameters; those of the heater's temperatures move with the melting range."""
    low, high = np.array(list(FREE.values())).T
    begin_K = fixed.get("melting_C", DEFAULTS["melting_C"]) - DEFAULTS["melting_C"]
    end_K = begin_K + fixed.get("melting_range_K", DEFAULTS["melting_range_K"]) - DEFAULTS["melting_range_K"]
    return low + np.array([0.0, end_K, 0, 0, 0, 0, 0]), high + np.array([begin_K, end_K, 0, 0, 0, 0, 0])


def complete(free: FloatArray, fixed: Mapping[str, float]) -> dict[str, float]:
    """Return all numbers of a motor whose heater settles at `holding_C` with `holding_W`; raise `ValueError` if none.

    Held open, holding_W crosses core to body and body to ambient in series: this gives `body_ambient_W_K`.
    """
    values = {**DEFAULTS, **fixed, **dict(zip(FREE, map(float, free), strict=True))}
    body_C = values["holding_C"] - values["holding_W"] / values["core_body_W_K"]
    if body_C <= values["ambient_C"] + 1.0:
        raise ValueError("the core cannot give off its holding power")
    return {**values, "body_ambient_W_K": values["holding_W"] / (body_C - values["ambient_C"])}


def target_times(product: str) -> FloatArray:
    """Return the empirical model's settled times (profiles, times) [s]."""
    return steady_times(lambda signal: empirical(product, signal))


def model_times(values: Mapping[str, Any]) -> FloatArray:
    """Return the motor's settled times (profiles, times) [s]."""
    p = parameters(values)
    return steady_times(lambda signal: Rig(p).run(signal))


@dataclass(frozen=True)
class Problem:
    """One product's times, and the parameters that are held fixed at other values than the defaults."""

    product: str
    target: FloatArray
    fixed: Mapping[str, float]

    def values(self, free: FloatArray) -> dict[str, Any]:
        return {"product": self.product, **complete(free, self.fixed)}

    def errors_s(self, free: FloatArray) -> FloatArray:
        """Return all errors of the times, flat [s]."""
        try:
            errors: FloatArray = (model_times(self.values(free)) - self.target).ravel()
        except ValueError:
            return np.full(self.target.size, PENALTY_S)
        return errors

    def cost(self, free: FloatArray) -> float:
        """Return the sum of squares, growing in a line beyond 30 s so that the search is not led by one time."""
        size = np.abs(self.errors_s(free))
        return float(np.sum(np.where(size < 30.0, size * size, 60.0 * size - 900.0)))


def refitted(product: str, fixed: Mapping[str, float], start: Mapping[str, float] | None = None) -> dict[str, Any]:
    """Return all numbers of the local optimum nearest to a start (the present fit) with others held fixed.

    For another melting point the start is the fit with temperatures above ambient scaled and capacities against them.
    """
    values = {name: PRODUCTS[product][name] for name in FREE} | dict(start or {})
    ambient_C = fixed.get("ambient_C", DEFAULTS["ambient_C"])
    melting_C = fixed.get("melting_C", DEFAULTS["melting_C"])
    ratio = (melting_C - ambient_C) / (DEFAULTS["melting_C"] - DEFAULTS["ambient_C"])
    for name in ("knee_C", "holding_C"):
        values[name] = ambient_C + ratio * (values[name] - DEFAULTS["ambient_C"])
    for name in ("cup_J_K", "body_J_K", "core_body_W_K"):
        values[name] /= ratio
    task = problem(product, fixed)
    return task.values(polish(task, np.array(list(values.values()))))


def problem(product: str, fixed: Mapping[str, float] | None = None) -> Problem:
    return Problem(product, target_times(product), fixed or {})


def fitted(product: str) -> FloatArray:
    """Return the free parameters as they lie in `products.py`."""
    return np.array([PRODUCTS[product][name] for name in FREE])


def polish(task: Problem, start: FloatArray) -> FloatArray:
    """Return the local least-squares optimum from a start."""
    from scipy.optimize import least_squares

    low, high = bounds(task.fixed)
    inside = np.clip(start, low + 1e-6, high - 1e-6)
    # parameters are scaled by their bounds; the step is coarse enough to see through interpolation between steps
    done = least_squares(
        task.errors_s, inside, bounds=(low, high), x_scale=high - low, diff_step=np.full(len(inside), 1e-4)
    )
    best: FloatArray = min((done.x, inside), key=task.cost)
    return best


def search(task: Problem, seed: int) -> FloatArray:
    """Return the optimum of one global search."""
    from scipy.optimize import Bounds, differential_evolution

    limits = Bounds(*bounds(task.fixed))
    found = differential_evolution(
        task.cost, limits, seed=seed, popsize=10, maxiter=200, tol=1e-8, polish=False, init="sobol"
    )
    return polish(task, found.x)


def refit(product: str) -> list[FloatArray]:
    """Return the optimum of each of several global searches, the best first."""
    task = problem(product)
    return sorted((search(task, seed) for seed in SEEDS), key=task.cost)


@dataclass(frozen=True)
class Identifiability:
    """What the times say of the logarithms of the free parameters, linearised at the fit."""

    free: FloatArray
    low: FloatArray  # 95 % range with the residual as noise
    high: FloatArray
    singular_s: FloatArray  # change of the times (root sum of squares) per unit change along each direction [s]
    directions: FloatArray  # (directions, parameters)
    noise_s: float


def identifiability(task: Problem, free: FloatArray) -> Identifiability:
    """Return ranges and directions from the Jacobian d times / d ln(parameters)."""
    from scipy.stats import t as student

    columns = []
    for i in range(len(free)):
        up, down = free.copy(), free.copy()
        up[i] *= 1.01
        down[i] /= 1.01
        columns.append((task.errors_s(up) - task.errors_s(down)) / (2.0 * np.log(1.01)))
    jacobian = np.array(columns).T
    errors = task.errors_s(free)
    freedom = len(errors) - len(free)
    noise_s = float(np.sqrt(np.sum(errors**2) / freedom))
    _, singular, directions = np.linalg.svd(jacobian, full_matrices=False)
    variance = noise_s**2 * np.sum((directions.T / singular) ** 2, axis=1)
    width = student.ppf(0.975, freedom) * np.sqrt(variance)
    return Identifiability(free, free * np.exp(-width), free * np.exp(width), singular, directions, noise_s)
