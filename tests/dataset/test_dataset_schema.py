"""The JSON Schema of dataset.toml accepts what the reader does, and marks misspelled keys."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator

from tests.conftest import ROOT, Waxstudy
from tests.importing.conftest import made, record
from tests.importing.exports import Export
from tests.study.regenerate_schema import OF_DATASETS, own, text_of_datasets
from tests.test_docs import blocks
from waxstudy.dataset.schema import dataset_schema

__all__ = ["made", "record"]

EXAMPLES = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "studies").rglob("dataset.toml"))]
EXAMPLES += blocks(ROOT / "docs" / "datasets-files.md", "toml")
MISSPELLED = {
    "dataset": ("[dataset]\nintervall_s = 60\n", ["dataset"]),
    "table": ("[bilding]\nuse = 'nzeb'\n", []),
    "channel": ("[noise]\nsensor_temperature = 0.1\n", ["noise"]),
    "component": ("[nominal]\ncontroller = { use = 'onoff' }\n", ["nominal", "controller", "use"]),
    "number": ("[building]\nheight_m = 'two'\n", ["building", "height_m"]),
}


def refusals(text: str) -> list[list[Any]]:
    """The places that an editor marks."""
    values = json.loads(json.dumps(tomllib.loads(text), default=str))
    return [list(error.absolute_path) for error in Draft7Validator(dataset_schema(own())).iter_errors(values)]


def test_the_committed_copy_is_current() -> None:
    assert OF_DATASETS.read_text(encoding="utf-8") == text_of_datasets()


def test_the_command_prints_a_valid_schema(waxstudy: Waxstudy) -> None:
    schema = json.loads(waxstudy("schema", "--dataset").stdout)
    Draft7Validator.check_schema(schema)
    assert schema["title"] == "dataset.toml of waxstudy"


@pytest.mark.parametrize("example", EXAMPLES)
def test_every_dataset_and_every_example_of_the_page_is_valid(example: str) -> None:
    assert refusals(example) == []


def test_what_an_import_writes_is_valid(made: dict[str, Export], waxstudy: Waxstudy, tmp_path: Path) -> None:
    assert waxstudy("import", made["german_csv"].source, "--out", "living").returncode == 0
    assert refusals((tmp_path / "living/dataset.toml").read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(("text", "place"), MISSPELLED.values(), ids=MISSPELLED)
def test_what_is_misspelled_is_marked(text: str, place: list[Any]) -> None:
    assert place in refusals(text)
