"""Print how the motor agrees with the empirical model and what the times determine; `--refit` fits it again.

python -m waxstudy_enthalpy.fit [--refit]
"""

from __future__ import annotations

import argparse

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy_enthalpy import agreement
from waxstudy_enthalpy.calibration import (
    FREE,
    SEEDS,
    complete,
    fitted,
    identifiability,
    model_times,
    problem,
    refit,
    refitted,
    target_times,
)
from waxstudy_enthalpy.products import PRODUCTS

# what the times cannot fix is held at one value; these are others, each refitted from the present fit
ALTERNATIVES: tuple[dict[str, float], ...] = (
    {"friction_N": 5.0},
    {"friction_N": 50.0},
    {"inrush_W": 5.0},
    {"inrush_W": 7.0},
    {"latent_J_g": 170.0},
    {"latent_J_g": 220.0},
    {"melting_range_K": 7.0},
    {"melting_range_K": 13.0},
    {"melting_C": 60.0, "melting_range_K": 8.1},
    {"melting_C": 50.0, "melting_range_K": 6.0},
    {"ambient_C": 23.0},
)


def rounded(product: str, free: FloatArray) -> dict[str, float]:
    """Return the fitted numbers as they are kept: four figures, and the body's loss that follows from them."""
    kept = np.array([float(f"{value:.4g}") for value in free])
    values = complete(kept, {})
    return {name: float(f"{values[name]:.4g}") for name in PRODUCTS[product]}


def print_refit() -> None:
    print(f"\nFitted again: differential evolution with seeds {SEEDS}, each polished by least squares; best first")
    for product in "AB":
        task = problem(product)
        for free in refit(product):
            size = np.abs(task.errors_s(free))
            print(f"{product}: error {size.mean():.2f} s mean, {size.max():.2f} s worst, {_rms(size):.2f} s rms")
            print("   " + ", ".join(f'"{name}": {value}' for name, value in rounded(product, free).items()))


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def print_identifiability() -> None:
    """Print ranges of the free parameters, and the directions that the times see least and most."""
    for product in "AB":
        found = identifiability(problem(product), fitted(product))
        print(f"\n{product}: free parameters, 95 % range if the error that is left ({found.noise_s:.1f} s) were noise")
        for name, *row in zip(FREE, found.free, found.low, found.high, strict=True):
            print(f"  {name:15} {row[0]:9.4g}  {row[1]:9.4g} .. {row[2]:.4g}")
        print("  change of the times (root sum of squares) for 1 % along each direction [s]")
        for size, direction in zip(found.singular_s, found.directions, strict=True):
            parts = [f"{w:+.2f} {name}" for name, w in zip(FREE, direction, strict=True) if abs(w) > 0.25]
            print(f"  {size / 100.0:7.2f}  {', '.join(parts)}")


def print_alternatives() -> None:
    print("\nOther values of what is held fixed, the rest refitted from the present fit: errors [s] and parameters")
    print(f"{'':36}{'mean':>6}{'worst':>7} " + "".join(f"{name:>15}" for name in FREE))
    for product in "AB":
        for fixed in ({}, *ALTERNATIVES):
            values = refitted(product, fixed)
            size = np.abs(model_times(values) - target_times(product))
            label = ", ".join(f"{name} {value:g}" for name, value in fixed.items()) or "as fitted"
            cells = "".join(f"{values[name]:15.4g}" for name in FREE)
            print(f"{product} {label:34}{size.mean():6.2f}{size.max():7.2f} {cells}")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m waxstudy_enthalpy.fit", description=__doc__.splitlines()[0])
    parser.add_argument("--refit", action="store_true", help="fit again (some minutes) and print the parameters")
    arguments = parser.parse_args()
    agreement.print_all()
    print_identifiability()
    print_alternatives()
    if arguments.refit:
        print_refit()


if __name__ == "__main__":
    main()
