"""What is to be exported: a block by name or from a fragment, or the chain of a case."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from waxstudy.cli.errors import INVALID, PLUGIN, USAGE, CommandError
from waxstudy.cli.study import load_study

if TYPE_CHECKING:
    from waxstudy.export.model import Model
    from waxstudy.plugin import Choice


def chosen(file: Path | None, use: str | None, kind: str | None, values: dict[str, Any]) -> Choice:
    """Return one block with its parameters."""
    from waxstudy.plugin.registry import installed
    from waxstudy.study.problems import StudyError
    from waxstudy.study.single import block_of_fragment

    if (file is None) == (use is None):
        raise CommandError("name a file with a block, or a block with --use", USAGE)
    if use is not None:
        return _named(use, kind, values)
    assert file
    try:
        return block_of_fragment(file, installed(), values)
    except StudyError as error:
        raise CommandError(str(error), PLUGIN if error.is_plugin_fault else INVALID, label="") from error


def _named(use: str, kind: str | None, values: dict[str, Any]) -> Choice:
    from waxstudy.cli.plugins.lookup import registered
    from waxstudy.plugin import CHAIN, Choice

    found = [entry.component for entry in registered(use) if kind in (None, entry.component.kind)]
    blocks = [component for component in found if component.kind in CHAIN]
    if len(blocks) != 1:
        kinds = [component.kind for component in blocks]
        wrong = f"there is one among each of {', '.join(kinds)}: add --kind" if kinds else "no block of a chain"
        raise CommandError(f"--use {use}: {wrong}", USAGE)
    try:
        return Choice.of(blocks[0], values)
    except ValueError as error:
        raise CommandError(f"{blocks[0].kind} '{use}': {error}", USAGE) from error


def block(file: Path | None, use: str | None, kind: str | None, values: dict[str, Any], step_s: float) -> Model:
    """Return one block as a model."""
    choice = chosen(file, use, kind, values)
    from waxstudy.export.chain import block_model

    return block_model(choice, step_s)


def chain(file: Path, case: str) -> Model:
    """Return the chain of a study's case as a model."""
    blocks, step_s = case_of(file, case)
    from waxstudy.export.chain import chain_model

    return chain_model(blocks, step_s)


def case_of(file: Path, case: str) -> tuple[Mapping[str, Choice], float]:
    """Return the blocks of a study's case, and the study's step [s]."""
    from waxstudy.plugin.registry import hint

    study = load_study(file)
    if case not in study.cases:
        known = ", ".join(study.cases)
        raise CommandError(f"--case {case}: no case of {file}{hint(case, study.cases)} (it has: {known})", USAGE)
    return study.cases[case].blocks, study.step_s
