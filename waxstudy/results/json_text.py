"""Data as JSON, which has neither NaN nor infinity: both are null."""

from __future__ import annotations

import json
import math
from typing import Any


def json_text(data: dict[str, Any]) -> str:
    r"""
    >>> json_text({"heat": math.nan, "cycles": (1, 2.5)})
    '{\n "heat": null,\n "cycles": [\n  1,\n  2.5\n ]\n}\n'
    """
    return json.dumps(_finite(data), indent=1, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
