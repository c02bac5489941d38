"""The actuator's model: all four characteristic times of every product from the cycles of their records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from waxstudy.identification.curves import COOLING, HEATING, Shape
from waxstudy.identification.forms import Data, model_of
from waxstudy.identification.models import TimeModel, Value
from waxstudy.identification.scatter import Nesting
from waxstudy.plugin import FloatArray

if TYPE_CHECKING:
    import pandas as pd

# time -> its shape, and what came before (fall is taken for constant, as in the paper)
TIMES: Mapping[str, tuple[Shape | None, str]] = {
    "dead": (COOLING, "before_s"),
    "rise": (COOLING, "before_s"),
    "hold": (HEATING, "overheat_s"),
    "fall": (None, ""),
}
SEED = 1


@dataclass(frozen=True)
class ActuatorModel:
    """Times by name."""

    times: Mapping[str, TimeModel]

    @property
    def products(self) -> list[str]:
        return list(self.times["fall"].curves)

    def coefficients(self, product: str) -> dict[str, Value]:
        """Return the coefficients as the actuator `variable-times` calls them; without a curve a is 0."""
        found: dict[str, Value] = {}
        for name, time in self.times.items():
            curve = time.curves[product]
            if name == "fall":
                found["fall_s"] = curve.b_s
            else:
                found |= {f"{name}_a_s": curve.a_s, f"{name}_b_s": curve.b_s, f"{name}_tau_s": curve.tau_s}
        return found

    def untold(self) -> list[str]:
        return [sentence for time in self.times.values() for sentence in time.untold]


def fit_actuator(cycles: pd.DataFrame, seed: int = SEED) -> ActuatorModel:
    """Return the model of the cycles that are not lost; each product needs at least one."""
    kept = cycles[cycles["lost"] == ""]
    products = sorted(kept["product"].unique())
    draw = np.random.default_rng(seed)
    times = {}
    for name, (shape, before) in TIMES.items():
        data = _data(kept, name, before, products)
        times[name] = model_of(data, shape, draw)
    return ActuatorModel(times)


def _data(kept: pd.DataFrame, name: str, before: str, products: Sequence[str]) -> Data:
    """Return the cycles that tell of one time; a product none of whose cycles does keeps those without a past."""
    import pandas as pd

    rows = kept
    if before:
        known = kept[kept[before].notna()]
        silent = [product for product in products if product not in set(known["product"])]
        rows = pd.concat([known, kept[kept["product"].isin(silent)]])
    record, records = pd.factorize(rows["record"])
    first = rows.drop_duplicates("record").set_index("record").loc[records]
    motors = pd.MultiIndex.from_frame(first[["product", "exemplar"]])
    exemplars = motors.unique()
    product_of = pd.Index(products).get_indexer(exemplars.get_level_values(0))
    past: FloatArray = rows[before].to_numpy(dtype=float) if before else np.full(len(rows), np.nan)
    return Data(
        name=name,
        products=list(products),
        product=pd.Index(products).get_indexer(pd.Index(rows["product"])),
        before_s=past,
        outcome_s=rows[f"{name}_s"].to_numpy(dtype=float),
        nesting=Nesting(record, exemplars.get_indexer(motors), product_of),
    )
