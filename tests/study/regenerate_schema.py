"""Write the schemas in studies/ again: `python -m tests.study.regenerate_schema`."""

from __future__ import annotations

import json

from tests.conftest import ROOT
from waxstudy.dataset.schema import dataset_schema
from waxstudy.plugin.registry import Registry, installed
from waxstudy.study.schema import schema

COMMITTED = ROOT / "studies" / "study.schema.json"
OF_DATASETS = ROOT / "studies" / "dataset.schema.json"


def own() -> Registry:
    """The components that come with waxstudy; more may be installed here."""
    components = {key: entry for key, entry in installed().components.items() if entry.package == "waxstudy"}
    return Registry(components)


def text() -> str:
    """As `waxstudy schema` prints it."""
    return json.dumps(schema(own()), indent=2) + "\n"


def text_of_datasets() -> str:
    """As `waxstudy schema --dataset` prints it."""
    return json.dumps(dataset_schema(own()), indent=2) + "\n"


if __name__ == "__main__":
    COMMITTED.write_text(text(), encoding="utf-8", newline="\n")
    OF_DATASETS.write_text(text_of_datasets(), encoding="utf-8", newline="\n")
