"""Pages: a template filled with tables, plots and words; one file each, that needs nothing from outside."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from waxstudy.report.table import Column
from waxstudy.results.run import Run
from waxstudy.study.visible import visible_lines

STYLES = {"figure": "", "theirs": "published", "list": "text long"}  # of other kinds of columns: text
MARKS = {
    **dict.fromkeys(("yes", "held", "agrees"), "good"),
    **dict.fromkeys(("not held", "differs"), "bad"),
    **dict.fromkeys(("no", "not resolved"), "open"),
}


def filled(template: str, **values: Any) -> str:
    """Return one of the page templates with its values; a name that it does not know is an error."""
    environment = Environment(
        loader=PackageLoader("waxstudy.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"svg": Markup, "quoted": _quoted, "style": _style}
    return visible_lines(environment.get_template(template).render(**values))


def _quoted(title: str) -> str:
    """Names of columns in quotation marks."""
    return re.sub(r"`([^`]*)`", r"“\1”", title)


def _style(column: Column[Any], text: str = "") -> str:
    """The classes of a column's heading, or of a cell with its text."""
    mark = MARKS.get(text, "") if column.kind == "verdict" else ""
    return f"{STYLES.get(column.kind, 'text')} {mark}".rstrip()


def provenance(run: Run) -> list[tuple[str, str]]:
    """Where the figures come from: the folder's name, then what the run says of itself."""
    return [("run folder", run.folder.resolve().name), *told(run.provenance)]


def told(said: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Names and what is said of them, in words."""
    return [(key, _words(value)) for key, value in said.items()]


def _words(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {item}" for key, item in value.items())
    return str(value)
