"""Fitted parameters of products A and B: printed by `python -m waxstudy_enthalpy.fit --refit`.

They reproduce the characteristic times of the paper's Table 2; no motor was measured for them.
"""

from collections.abc import Mapping

PRODUCTS: Mapping[str, Mapping[str, float]] = {
    "A": {
        "knee_C": 48.39,
        "holding_C": 93.2,
        "cup_J_K": 14.62,
        "body_J_K": 12.93,
        "wax_g": 0.6434,
        "core_body_W_K": 0.06509,
        "body_ambient_W_K": 0.04041,
        "expansion_mm": 3.868,
    },
    "B": {
        "knee_C": 56.72,
        "holding_C": 79.03,
        "cup_J_K": 16.82,
        "body_J_K": 45.43,
        "wax_g": 1.157,
        "core_body_W_K": 0.04263,
        "body_ambient_W_K": 0.1139,
        "expansion_mm": 5.865,
    },
}
