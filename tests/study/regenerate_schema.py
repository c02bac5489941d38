"""Write studies/study.schema.json again: `python -m tests.study.regenerate_schema`."""

from __future__ import annotations

import json

from tests.conftest import ROOT
from waxstudy.plugin.registry import Registry, installed
from waxstudy.study.schema import schema

COMMITTED = ROOT / "studies" / "study.schema.json"


def own() -> Registry:
    """The components that come with waxstudy; more may be installed here."""
    components = {key: entry for key, entry in installed().components.items() if entry.package == "waxstudy"}
    return Registry(components)


def text() -> str:
    """As `waxstudy schema` prints it."""
    return json.dumps(schema(own()), indent=2) + "\n"


if __name__ == "__main__":
    COMMITTED.write_text(text(), encoding="utf-8", newline="\n")
