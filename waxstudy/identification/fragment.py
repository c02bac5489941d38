"""The TOML fragment that a fit leaves for study files: one block, and where it comes from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from waxstudy.identification.models import Value
from waxstudy.identification.performance import ACTUATOR
from waxstudy.identification.records import Record
from waxstudy.study.problems import Problem, StudyError
from waxstudy.study.source import read_source
from waxstudy.version import __version__

DIGITS = 4
MARK = "SIMULATED: its records come from a virtual test bench, no motor was measured."


def rounded(value: float) -> float:
    """Return a number with so many digits that nothing of a fit is lost.

    >>> rounded(206.03761), rounded(0.098765)
    (206.04, 0.09877)
    """
    return float(f"{value:.{DIGITS + 1}g}") if abs(value) >= 100.0 else float(f"{value:.{DIGITS}g}")


def allowed(coefficients: Mapping[str, Value]) -> tuple[dict[str, float], list[str]]:
    """Return coefficients as the block takes them, and what had to be changed: no time may be negative."""
    values = {name: rounded(each.value) for name, each in coefficients.items()}
    changed = []
    for name, least in (("dead", 0.0), ("rise", 1.0)):
        if values[f"{name}_a_s"] + values[f"{name}_b_s"] < least:
            changed.append(
                f"{name}_a_s is {least - values[f'{name}_b_s']:g}: the {name} time after no pause would be negative"
            )
            values[f"{name}_a_s"] = rounded(least - values[f"{name}_b_s"])
    if values["hold_b_s"] < 0.0:
        changed.append("hold_b_s is 0: the hold time without overheating would be negative")
        values["hold_b_s"] = 0.0
    return values, changed


def actuator_block(coefficients: Mapping[str, Value]) -> dict[str, Any]:
    return {"use": ACTUATOR, **allowed(coefficients)[0]}


def text_of(kind: str, block: Mapping[str, Any], about: Mapping[str, Any], origin: str = "") -> str:
    """Return a fragment: the block as a study names it, and `[fit]`, which a study does not read.

    It says first where its records come from, if that is told or they were simulated by the virtual bench.
    """
    import tomli_w

    says = MARK if about.get("simulated") else origin
    marked = "".join(f"# {line}\n" for line in says.splitlines())
    use = f'# In a study: {kind} = {{ from = "THIS FILE" }}\n'
    fit = {"waxstudy": __version__, **about}
    return f"{marked}{use}{tomli_w.dumps({kind: dict(block), 'fit': fit})}"


def intervals(values: Mapping[str, Value]) -> dict[str, list[float]]:
    """Return the 95 % intervals of what the data tell."""
    return {name: [rounded(v.low), rounded(v.high)] for name, v in values.items() if v.told}


def sources(records: Sequence[Record]) -> list[dict[str, Any]]:
    """Return each record's file with its hash."""
    return [{"name": record.name, "file": record.file, "sha256": record.sha256} for record in records]


def read_fragment(path: Path, kind: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the block of this kind, and what is known of its fit; raise `StudyError`."""
    values = read_source(path).values
    if not isinstance(values.get(kind), dict):
        raise StudyError([Problem(str(path), 0, f"[{kind}]", "", "", f"missing: the file describes no {kind}")])
    about = values.get("fit")
    return values[kind], about if isinstance(about, dict) else {}
