"""Write docs/bench.md again: `python -m tests.rig.regenerate_bench`."""

from __future__ import annotations

from docs_site.tables import table
from tests.conftest import ROOT
from waxstudy.rig.instruments import Bench

PAGE = ROOT / "docs" / "bench.md"
INTRO = """\
# The parameters of the virtual bench

This page lists what `waxstudy rig --bench KEY=VALUE` changes of the [virtual bench](fit.md#the-virtual-bench). It is
written by `make golden` from `waxstudy/rig/instruments.py`.

"""


def page() -> str:
    """The page as it should be: every parameter with its unit and default."""
    rows = []
    for name, field in Bench.model_fields.items():
        told = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        unit = str(told.get("unit", ""))
        rows.append((f"`{name}`", "" if unit == "1" else unit, f"{field.default:g}", field.description or ""))
    return INTRO + table(("parameter", "unit", "default", "what it is"), rows)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8", newline="\n")
