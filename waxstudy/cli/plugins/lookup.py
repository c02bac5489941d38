"""What the user names: a registered component, or a class in a module."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.errors import PLUGIN, USAGE, CommandError
from waxstudy.cli.output import print_out, stdout

if TYPE_CHECKING:
    from rich.table import Table

    from waxstudy.plugin.registry import Registered

NARROWEST = 100


def registered(name: str) -> list[Registered]:
    """Return the components of this name, of any kind; say which is nearest if there is none."""
    from waxstudy.plugin.registry import hint, installed
    from waxstudy.plugin.scaffold import package_of

    registry = installed()
    found = [entry for (_, own), entry in sorted(registry.components.items()) if own == name]
    if found:
        return found
    if name in registry.broken:
        raise CommandError(f"plugin '{name}' is broken: {registry.broken[name]}", PLUGIN)
    names = sorted({own for _, own in registry.components})
    near = hint(name, names)
    broken = f"; broken plugins: {', '.join(registry.broken)}" if registry.broken else ""
    if name.isidentifier() and _found_here(name):
        near = f"; a class of the module of this name is checked as {name}:CLASS"
    if os.path.isfile(os.path.join(package := package_of(name), "pyproject.toml")):
        near = f"; it may be in the folder {package}: python -m pip install --editable {package}"
    raise CommandError(f"no component '{name}'{near} (installed: {', '.join(names)}){broken}", PLUGIN)


def _found_here(module: str) -> bool:
    """Whether there is a module of this name, in the current folder or installed; a class there can be imported."""
    if "" not in sys.path:
        sys.path.insert(0, "")
    return module in sys.modules or find_spec(module) is not None


def imported(target: str) -> Any:
    """Return the object that `module:Class` names, also from the current folder; raise `PluginError` if it cannot."""
    from waxstudy.plugin.registry import PluginError, contained, hint, told

    module, _, name = target.partition(":")
    if not all(module.split(".")) or not name or ":" in name:
        raise CommandError(f"'{target}' names no class: write MODULE:CLASS, as in my_motor:Motor", USAGE)
    if not _found_here(module.partition(".")[0]):
        raise PluginError(f"no module '{module}' in the current folder, and none installed")
    with told(), contained():
        found = import_module(module)
        known = dir(found)
        if hasattr(found, name):
            return getattr(found, name)
    raise PluginError(f"module '{module}' has no '{name}'{hint(name, known)}")


def table(headings: Sequence[str]) -> Table:
    from rich.table import Table as RichTable

    made = RichTable(*headings, box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    made.columns[0].no_wrap = True  # a name that is cut off cannot be copied
    return made


def print_tables(*parts: object) -> None:
    """Print texts and tables on stdout, as wide as the terminal."""
    import io
    import shutil

    from rich.console import Console

    width = max(NARROWEST, shutil.get_terminal_size((120, 24)).columns)
    out = io.StringIO()
    colour = stdout().isatty()
    console = Console(file=out, width=width, force_terminal=colour, no_color=not colour, highlight=False, emoji=False)
    for part in parts:
        console.print(part, markup=False, soft_wrap=isinstance(part, str))
    print_out("\n".join(line.rstrip() for line in out.getvalue().splitlines()) + "\n")


def print_json(value: Mapping[str, Any] | Sequence[Any]) -> None:
    import json

    print_out(json.dumps(value, indent=2, default=str) + "\n")


as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
